#include "soft_demo_parts.hpp"

#include <array>

namespace grapeshot::bench::demo {

namespace {

void cloth(World& world) {
    flatGround(world);
    btSoftBody* body = patch(world, 8, 0, 31, 15);
    body->getCollisionShape()->setMargin(number(0.5));
    bend(*body, 0.4);
    body->setTotalMass(150);
    world.add(body);
    stack(world, 10);
}

void pressure(World& world) {
    flatGround(world);
    btSoftBody* body = ball(world, at(35, 25, 0));
    body->m_materials[0]->m_kLST = number(0.1);
    body->m_cfg.kDF = 1;
    body->m_cfg.kDP = number(0.001);
    body->m_cfg.kPR = 2500;
    body->setTotalMass(30, true);
    world.add(body);
    plate(world, 15, 4);
    stair(world, at(0, 0, 0), at(2, 1, 5), 10);
}

void volume(World& world) {
    flatGround(world);
    keepingVolume(world, at(35, 25, 0));
    plate(world, 15, 4);
    stair(world, at(0, 0, 0), at(2, 1, 5), 10);
}

void ropes(World& world) {
    flatGround(world);
    for (int i = 0; i < 15; ++i) {
        btSoftBody* body =
            btSoftBodyHelpers::CreateRope(world.info(), at(-10, 0, 0.25 * i), at(10, 0, 0.25 * i), 16, 3);
        body->m_cfg.piterations = 4;
        body->m_materials[0]->m_kLST = number(0.1 + 0.9 * i / 14);
        body->setTotalMass(20);
        world.add(body);
    }
}

void ropeAttach(World& world) {
    flatGround(world);
    btRigidBody& block = world.add(box(2, 6, 2), at(12, 8, 0), 50);
    for (const double z : {-1.0, 1.0}) {
        btSoftBody* rope = btSoftBodyHelpers::CreateRope(world.info(), at(0, 8, z), at(10, 8, z), 8, 1);
        rope->setTotalMass(50);
        world.add(rope).appendAnchor(rope->m_nodes.size() - 1, &block);
    }
}

void clothAttach(World& world) {
    flatGround(world);
    btSoftBody& body = world.add(patch(world, 4, 6, 9, 12));
    btRigidBody& block = world.add(box(4, 1, 3), at(0, 6, -7.5), 20);
    body.appendAnchor(0, &block);
    body.appendAnchor(8, &block);
}

void sticks(World& world) {
    flatGround(world);
    for (int i = 0; i < 256; ++i) {
        const btVector3 foot = at(-5 + 10 * (i % 16) / 15.0, -10, -5 + 10 * (i / 16) / 15.0);
        btSoftBody* stick = btSoftBodyHelpers::CreateRope(world.info(), foot, foot + at(0.004, 4, 0), 4, 1);
        stick->m_cfg.kDP = number(0.005);
        stick->m_cfg.kCHR = number(0.1);
        for (int k = 2; k < 5; ++k) {
            stick->generateBendingConstraints(k);
        }
        stick->setMass(1, 0);
        stick->setTotalMass(number(0.01));
        world.add(stick);
    }
    world.add(new btSphereShape(3), at(0, 13, 0), 10);
}

void capsuleCollision(World& world) {
    flatGround(world);
    auto* capsule = new btCapsuleShapeX(1, 5);
    world.add(capsule, at(0, 4, 0), 0, number(0.8));
    btSoftBody* body = patch(world, 4, 6, 20, 0);
    body->setTotalMass(number(0.1));
    body->m_cfg.piterations = body->m_cfg.citerations = body->m_cfg.diterations = 10;
    world.add(body);
}

void collide(World& world) {
    flatGround(world);
    for (int i = 0; i < 3; ++i) {
        btSoftBody* body = torus(world);
        body->generateBendingConstraints(2);
        body->m_cfg.piterations = 2;
        body->m_cfg.collisions |= Flags::VF_SS;
        body->randomizeConstraints();
        turn(*body, pi / 2 * btScalar(1 - i % 2), pi / 2 * btScalar(i % 2), 0, at(3 * i, 2, 0));
        body->setTotalMass(50, true);
        world.add(body);
    }
}

void collide2(World& world) {
    flatGround(world);
    for (int i = 0; i < 3; ++i) {
        btSoftBody* body = lumpyBall(world);
        bend(*body, 0.5);
        body->m_cfg.piterations = 2;
        body->m_cfg.kDF = number(0.5);
        body->m_cfg.collisions |= Flags::VF_SS;
        body->randomizeConstraints();
        turn(*body, 0, pi / 2 * btScalar(i % 2), 0, at(0, -1 + 8 * i, 0));
        body->setTotalMass(100, true);
        world.add(body);
    }
}

void collide3(World& world) {
    flatGround(world);
    btSoftBody* held = patch(world, 8, 0, 15, 15);
    held->m_materials[0]->m_kLST = number(0.4);
    btSoftBody* falling = patch(world, 4, 0, 7, 0, at(5, 10, 0));
    bend(*falling, 0.1);
    falling->m_materials[0]->m_kLST = number(0.5);
    for (btSoftBody* body : {held, falling}) {
        body->m_cfg.collisions |= Flags::VF_SS;
        body->setTotalMass(150);
        world.add(body);
    }
}

void impact(World& world) {
    flatGround(world);
    world.add(btSoftBodyHelpers::CreateRope(world.info(), at(0, 0, 0), at(0, -1, 0), 0, 1)).m_cfg.kCHR = number(0.5);
    world.add(box(2, 2, 2), at(0, 20, 0), 10);
}

void aero(World& world) {
    flatGround(world);
    for (std::uint32_t i = 0; i < 50; ++i) {
        btSoftBody* body = patch(world, 2, 10, 6, 0);
        body->generateBendingConstraints(2, body->appendMaterial());
        body->m_cfg.kLF = number(0.004);
        body->m_cfg.kDG = number(0.0003);
        body->m_cfg.aeromodel = btSoftBody::eAeroModel::V_TwoSided;
        btQuaternion rotation;
        rotation.setEuler(pi / 8 + number(0.1 * drawn(6 * i)), -pi / 7 + number(0.1 * drawn(6 * i + 1)),
                          number(0.1 * drawn(6 * i + 2)));
        body->transform(
            btTransform(rotation, at(15 * drawn(6 * i + 3), 20 + 15 * drawn(6 * i + 4), 80 + 15 * drawn(6 * i + 5))));
        body->setTotalMass(number(0.1));
        body->addForce(at(0, 2, 0), 0);
        world.add(body);
    }
}

void aero2(World& world) {
    flatGround(world);
    for (int i = 0; i < 5; ++i) {
        btSoftBody* body = btSoftBodyHelpers::CreatePatch(world.info(), at(-5, 0, -15), at(5, 0, -15), at(-5, 0, 5),
                                                          at(5, 0, 5), 10, 30, 3, true);
        body->getCollisionShape()->setMargin(number(0.5));
        bend(*body, 0.0004);
        body->m_cfg.kLF = number(0.05);
        body->m_cfg.kDG = number(0.01);
        body->m_cfg.piterations = 2;
        body->m_cfg.aeromodel = btSoftBody::eAeroModel::V_TwoSidedLiftDrag;
        body->setWindVelocity(at(4, -12, -25));
        body->transform(btTransform(btQuaternion(at(1, 0, 0), pi / 2), at(-50 + 10.5 * (i + 1), 0, 0)));
        body->setTotalMass(2);
        btSoftBodyHelpers::ReoptimizeLinkOrder(body);
        world.add(body);
    }
}

void friction(World& world) {
    flatGround(world);
    for (int i = 0; i < 20; ++i) {
        std::array<btVector3, 8> corners;
        for (std::size_t k = 0; k < 8; ++k) {
            corners[k] = at(-25 + 2.5 * i + (k & 1U ? 1 : -1), -8 + (k & 2U ? 1 : -1), 40 + (k & 4U ? 1 : -1));
        }
        btSoftBody* body = btSoftBodyHelpers::CreateFromConvexHull(world.info(), corners.data(), 8);
        body->generateBendingConstraints(2);
        body->m_cfg.kDF = number(0.1 * (i + 1) / 20);
        body->addVelocity(at(0, 0, -10));
        world.add(body);
    }
}

void torusDemo(World& world) {
    flatGround(world);
    btSoftBody* body = torus(world);
    body->generateBendingConstraints(2);
    body->m_cfg.piterations = 2;
    body->randomizeConstraints();
    turn(*body, pi / 2, 0, 0, at(0, 4, 0));
    body->setTotalMass(50, true);
    world.add(body);
}

void torusMatch(World& world) {
    flatGround(world);
    btSoftBody* body = torus(world);
    body->m_materials[0]->m_kLST = number(0.1);
    body->m_cfg.kMT = number(0.05);
    body->randomizeConstraints();
    turn(*body, pi / 2, 0, 0, at(0, 4, 0));
    body->setTotalMass(50, true);
    body->setPose(false, true);
    world.add(body);
}

void bunny(World& world) {
    flatGround(world);
    btSoftBody* body = lumpyBall(world);
    bend(*body, 0.5);
    body->m_cfg.piterations = 2;
    body->m_cfg.kDF = number(0.5);
    body->randomizeConstraints();
    body->setTotalMass(100, true);
    world.add(body);
}

void bunnyMatch(World& world) {
    flatGround(world);
    btSoftBody* body = lumpyBall(world);
    body->m_cfg.kDF = number(0.5);
    body->m_cfg.kMT = number(0.05);
    body->m_cfg.piterations = 5;
    body->randomizeConstraints();
    body->setTotalMass(100, true);
    body->setPose(false, true);
    world.add(body);
}

void cutting(World& world) {
    flatGround(world);
    world.add(patch(world, 6, 2, 16, 15)).m_cfg.piterations = 1;
}

/// Not one of theirs: what their last scenes have of clusters, by nodes, which is where a mesh is ours.
void tetraCubeByNodes(World& world) {
    wavyGround(world);
    btSoftBody* body = block(world, at(0, 5, 0), 4, 4);
    body->setTotalMass(300);
    body->m_cfg.piterations = 4;
    body->m_materials[0]->m_kLST = number(0.8);
    body->getCollisionShape()->setMargin(number(0.1));
    world.add(body);
}

void clothByNodes(World& world) {
    wavyGround(world);
    btSoftBody* body = patch(world, 8, 0, 31, 0);
    bend(*body, 0.4);
    body->getCollisionShape()->setMargin(number(0.25));
    body->setTotalMass(50);
    world.add(body);
}

constexpr std::array scenes{
    SoftDemo{"Cloth", false, cloth},
    SoftDemo{"Pressure", false, pressure},
    SoftDemo{"Volume", false, volume},
    SoftDemo{"Ropes", false, ropes},
    SoftDemo{"RopeAttach", false, ropeAttach},
    SoftDemo{"ClothAttach", false, clothAttach},
    SoftDemo{"Sticks", false, sticks},
    SoftDemo{"CapsuleCollision", false, capsuleCollision},
    SoftDemo{"Collide", false, collide},
    SoftDemo{"Collide2", false, collide2},
    SoftDemo{"Collide3", false, collide3},
    SoftDemo{"Impact", false, impact},
    SoftDemo{"Aero", false, aero},
    SoftDemo{"Aero2", false, aero2},
    SoftDemo{"Friction", false, friction},
    SoftDemo{"Torus", false, torusDemo},
    SoftDemo{"TorusMatch", false, torusMatch},
    SoftDemo{"Bunny", false, bunny},
    SoftDemo{"BunnyMatch", false, bunnyMatch},
    SoftDemo{"Cutting1", false, cutting},
    SoftDemo{"tetrahedra on a mesh by nodes", false, tetraCubeByNodes},
    SoftDemo{"cloth on a mesh by nodes", false, clothByNodes},
};

}  // namespace

std::span<const SoftDemo> nodeScenes() {
    return scenes;
}

}  // namespace grapeshot::bench::demo
