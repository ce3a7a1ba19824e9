#include "soft_demo_scenes.hpp"

#include <BulletSoftBody/btDeformableNeoHookeanForce.h>

#include <array>
#include <cmath>
#include <memory>

#include <grapeshot/core/random.hpp>

namespace grapeshot::bench {

namespace {

using Flags = btSoftBody::fCollision;
using World = SoftDemoWorld;

constexpr btScalar pi = SIMD_PI;

btScalar number(double value) {
    return static_cast<btScalar>(value);
}

btVector3 at(double x, double y, double z) {
    return {number(x), number(y), number(z)};
}

/// A number of -1..1.
double drawn(std::uint32_t index) {
    return 2 * static_cast<double>(randomUnit({11, 0}, index)) - 1;
}

btBoxShape* box(double x, double y, double z) {
    return new btBoxShape(at(x, y, z));
}

void flatGround(World& world) {
    world.add(box(100, 1.5, 100), at(0, -12, 0), 0);
}

void wavyGround(World& world) {
    scenes::Mesh mesh = scenes::grid(120, 120, 29, 29);
    for (Eigen::Vector3f& v : mesh.vertices) {
        v.y() = 1.2F * std::sin(v.x() / 8.3F) * std::cos(v.z() / 8.3F - 50);
    }
    world.addMesh(mesh, at(0, -12, 0));
}

btSoftBody* patch(World& world, double half, double height, int nodes, int fixed, const btVector3& place = {0, 0, 0}) {
    const auto corner = [&](double x, double z) { return place + at(x * half, height, z * half); };
    return btSoftBodyHelpers::CreatePatch(world.info(), corner(-1, -1), corner(1, -1), corner(-1, 1), corner(1, 1),
                                          nodes, nodes, fixed, true);
}

btSoftBody* ofMesh(World& world, const scenes::Mesh& mesh) {
    std::vector<btScalar> vertices;
    for (const Eigen::Vector3f& v : mesh.vertices) {
        vertices.insert(vertices.end(), {btScalar(v.x()), btScalar(v.y()), btScalar(v.z())});
    }
    std::vector<int> corners;
    for (const Triangle& t : mesh.triangles) {
        corners.insert(corners.end(), {static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2])});
    }
    return btSoftBodyHelpers::CreateFromTriMesh(world.info(), vertices.data(), corners.data(),
                                                static_cast<int>(mesh.triangles.size()));
}

btSoftBody* torus(World& world) {
    return ofMesh(world, scenes::torus(2, 0.7F, 24, 12));
}
btSoftBody* lumpyBall(World& world) {
    return ofMesh(world, scenes::bumpySphere(3, 0.6F, 5, 7));
}

void bend(btSoftBody& body, double stiffness) {
    btSoftBody::Material* material = body.appendMaterial();
    material->m_kLST = number(stiffness);
    body.generateBendingConstraints(2, material);
}

void turn(btSoftBody& body, double x, double y, double z, const btVector3& place) {
    btMatrix3x3 rotation;
    rotation.setEulerZYX(number(x), number(y), number(z));
    body.transform(btTransform(rotation, place));
}

void stack(World& world, int count) {
    auto* compound = new btCompoundShape;
    compound->addChildShape(btTransform::getIdentity(), world.keep(box(4, 1, 1)));
    compound->addChildShape(btTransform(btQuaternion(SIMD_HALF_PI, 0, 0)),
                            world.keep(new btCylinderShapeX(at(4, 1, 1))));
    const std::array<btCollisionShape*, 3> shapes{world.keep(compound), world.keep(box(1, 1, 1)),
                                                  world.keep(new btSphereShape(number(1.5)))};
    for (int i = 0; i < count; ++i) {
        world.add(shapes[static_cast<std::size_t>(i % 3)], at(0, 2 + 6 * i, 0), 10);
    }
}

void plate(World& world, double mass, double height) {
    world.add(box(5, 1, 5), at(0, height, 0.5), number(mass), 1);
}

void stair(World& world, const btVector3& origin, const btVector3& half, int count) {
    btCollisionShape* step = world.keep(new btBoxShape(half));
    for (int i = 0; i < count; ++i) {
        world.add(step, origin + btVector3(2 * half.x() * btScalar(i), 2 * half.y() * btScalar(i), 0), 0, 1);
    }
}

// btSoftRigidDynamicsWorld.

void cloth(World& world) {
    flatGround(world);
    btSoftBody* body = patch(world, 8, 0, 31, 15);
    body->getCollisionShape()->setMargin(number(0.5));
    bend(*body, 0.4);
    body->setTotalMass(150);
    world.add(body);
    stack(world, 10);
}

btSoftBody* ball(World& world, const btVector3& place) {
    return btSoftBodyHelpers::CreateEllipsoid(world.info(), place, at(3, 3, 3), 512);
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

btSoftBody& keepingVolume(World& world, const btVector3& place) {
    btSoftBody* body = ball(world, place);
    body->m_materials[0]->m_kLST = number(0.45);
    body->m_cfg.kVC = 20;
    body->setTotalMass(50, true);
    body->setPose(true, false);
    return world.add(body);
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

btSoftBody& clusterTorus(World& world, const btVector3& place, const btVector3& angles, int clusters,
                         const btVector3& scale = {1, 1, 1}) {
    btSoftBody* body = torus(world);
    bend(*body, 1);
    body->m_cfg.piterations = 2;
    body->m_cfg.kDF = 1;
    body->m_cfg.collisions = Flags::CL_SS + Flags::CL_RS;
    body->randomizeConstraints();
    body->scale(scale);
    body->rotate(btQuaternion(angles[0], angles[1], angles[2]));
    body->translate(place);
    body->setTotalMass(50, true);
    body->generateClusters(clusters);
    return world.add(body);
}

void clusterDeform(World& world) {
    wavyGround(world);
    clusterTorus(world, at(0, 0, 0), {pi / 2, 0, SIMD_HALF_PI}, 8);
}

void clusterCollide1(World& world) {
    wavyGround(world);
    btSoftBody* body = patch(world, 8, 0, 17, 15);
    body->m_cfg.kDF = 1;
    body->m_cfg.kSRHR_CL = 1;
    body->m_cfg.kSR_SPLT_CL = 0;
    body->m_cfg.collisions = Flags::CL_SS + Flags::CL_RS;
    bend(*body, 0.4);
    body->getCollisionShape()->setMargin(number(0.05));
    body->setTotalMass(50);
    body->generateClusters(0);
    world.add(body);
    stack(world, 10);
}

void clusterCollide2(World& world) {
    wavyGround(world);
    for (int i = 0; i < 3; ++i) {
        btSoftBody& body =
            clusterTorus(world, at(3 * i, 2, 0), {pi / 2 * btScalar(1 - i % 2), pi / 2 * btScalar(i % 2), 0}, 16);
        body.m_cfg.kSSHR_CL = 1;
        body.m_cfg.kSS_SPLT_CL = 0;
        body.m_cfg.kSKHR_CL = number(0.1);
        body.m_cfg.kSK_SPLT_CL = 1;
    }
}

void clusterSocket(World& world) {
    wavyGround(world);
    btSoftBody& body = clusterTorus(world, at(0, 0, 0), {pi / 2, 0, SIMD_HALF_PI}, 64);
    btRigidBody& held = world.add(box(5, 1, 5), at(0, 8, 0.5), 50, 1);
    btSoftBody::LJoint::Specs joint;
    joint.position = at(0, 5, 0);
    body.appendLinearJoint(joint, btSoftBody::Body(&held));
}

void clusterHinge(World& world) {
    wavyGround(world);
    btSoftBody& body = clusterTorus(world, at(0, 0, 0), {pi / 2, 0, SIMD_HALF_PI}, 64);
    btRigidBody& held = world.add(box(5, 1, 5), at(0, 8, 0.5), 50, 1);
    btSoftBody::AJoint::Specs joint;
    joint.axis = at(0, 0, 1);
    body.appendAngularJoint(joint, btSoftBody::Body(&held));
}

void clusterCombine(World& world) {
    wavyGround(world);
    const btVector3 scale = at(1, 2, 1);
    btSoftBody& first = clusterTorus(world, at(0, 8, 0), {pi / 2, 0, SIMD_HALF_PI}, 64, scale);
    btSoftBody& second = clusterTorus(world, at(0, 8, 10), {pi / 2, 0, SIMD_HALF_PI}, 64, scale);
    btSoftBody::AJoint::Specs turning;
    turning.axis = at(0, 0, 1);
    first.appendAngularJoint(turning, &second);
    btSoftBody::LJoint::Specs held;
    held.position = at(0, 8, 5);
    first.appendLinearJoint(held, &second);
}

void clusterRobot(World& world) {
    wavyGround(world);
    const btVector3 base = at(0, 25, 8);
    std::array<btSoftBody*, 3> balls{};
    const std::array places{base + at(-8, 0, 0), base + at(8, 0, 0), base + at(0, 0, 8 * std::sqrt(2.0))};
    btVector3 middle(0, 0, 0);
    for (std::size_t i = 0; i < 3; ++i) {
        balls[i] = &keepingVolume(world, places[i]);
        balls[i]->generateClusters(1);
        middle += balls[i]->clusterCom(0) / 3;
    }
    btRigidBody& top = world.add(new btCylinderShape(at(8, 1, 8)), middle + at(0, 5, 0), 50);
    for (btSoftBody* body : balls) {
        btSoftBody::LJoint::Specs joint;
        joint.erp = number(0.5);
        joint.position = body->clusterCom(0);
        body->appendLinearJoint(joint, btSoftBody::Body(&top));
    }
    world.add(box(20, 1, 40), btTransform(btQuaternion(0, -SIMD_HALF_PI / 2, 0), at(0, 0, 0)), 0);
}

void clusterStackSoft(World& world) {
    wavyGround(world);
    for (int i = 0; i < 10; ++i) {
        clusterTorus(world, at(0, -9 + 8.25 * i, 0), {0, 0, 0}, 64);
    }
}

void clusterStackMixed(World& world) {
    wavyGround(world);
    for (int i = 0; i < 10; ++i) {
        if (i % 2 == 0) {
            plate(world, 50, -9 + 4.25 * i);
        } else {
            clusterTorus(world, at(0, -9 + 4.25 * i, 0), {0, 0, 0}, 64);
        }
    }
}

/// A block of cells^3 cubes of six tetrahedra each.
btSoftBody* block(World& world, const btVector3& middle, double half, int cells) {
    std::vector<btVector3> nodes;
    const int side = cells + 1;
    for (int i = 0; i < side * side * side; ++i) {
        const auto along = [&](int k) { return half * (2.0 * k / cells - 1); };
        nodes.push_back(middle + at(along(i % side), along(i / side % side), along(i / side / side)));
    }
    auto* body = new btSoftBody(&world.info(), static_cast<int>(nodes.size()), nodes.data(), nullptr);
    constexpr std::array<std::array<int, 4>, 6> six{
        {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}}};
    for (int z = 0; z < cells; ++z) {
        for (int y = 0; y < cells; ++y) {
            for (int x = 0; x < cells; ++x) {
                for (const auto& t : six) {
                    std::array<int, 4> n{};
                    for (std::size_t k = 0; k < 4; ++k) {
                        n[k] = (x + t[k] % 2) + side * ((y + t[k] / 2 % 2) + side * (z + t[k] / 4));
                    }
                    body->appendTetra(n[0], n[1], n[2], n[3]);
                    for (std::size_t p = 0; p < 4; ++p) {
                        for (std::size_t q = p + 1; q < 4; ++q) {
                            body->appendLink(n[p], n[q], nullptr, true);
                        }
                    }
                }
            }
        }
    }
    return body;
}

void tetraCube(World& world) {
    wavyGround(world);
    btSoftBody* body = block(world, at(0, 5, 0), 4, 4);
    body->setVolumeMass(300);
    body->m_cfg.piterations = 1;
    body->m_materials[0]->m_kLST = number(0.8);
    body->getCollisionShape()->setMargin(number(0.01));
    body->m_cfg.collisions = Flags::CL_SS + Flags::CL_RS;
    body->generateClusters(16);
    world.add(body);
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

// btDeformableMultiBodyDynamicsWorld.

btSoftBody& deformableCloth(World& world, btSoftBody* body, double margin, double friction, int flags, double stiffness,
                            double damping) {
    body->getCollisionShape()->setMargin(number(margin));
    body->generateBendingConstraints(2);
    body->setTotalMass(1);
    body->m_cfg.kKHR = body->m_cfg.kCHR = 1;
    body->m_cfg.kDF = number(friction);
    body->m_cfg.collisions = Flags::SDF_RD | Flags::SDF_RDF | flags;
    return world.addDeformable(body, number(stiffness), number(damping));
}

void clothFriction(World& world) {
    world.add(box(150, 25, 150), btTransform(btQuaternion(at(1, 0, 0), pi / 10), at(0, -32, 0)), 0, 3);
    deformableCloth(world, patch(world, 4, 0, 10, 0), 0.06, 3, Flags::VF_DD, 10, 1).setSpringStiffness(100);
    deformableCloth(world, patch(world, 2, 0.5, 5, 0), 0.06, 1, Flags::VF_DD, 10, 0.1).setSpringStiffness(100);
}

void deformableClothAnchor(World& world) {
    world.add(box(150, 25, 150), at(0, -50, 0), 0, 1);
    btSoftBody& body = deformableCloth(world, patch(world, 4, 6, 8, 12), 0.1, 2, 0, 100, 1);
    btRigidBody& held = world.add(box(4, 1, 3), at(0, 6, -7.5), 1);
    body.appendDeformableAnchor(0, &held);
    body.appendDeformableAnchor(7, &held);
}

void deformableContact(World& world) {
    world.add(box(150, 25, 150), at(0, -32, 0), 0, 2);
    deformableCloth(world, patch(world, 4, 0, 20, 15, at(3.5, 0, 0)), 0.05, 0, Flags::VF_DD, 10, 1)
        .setSpringStiffness(10);
    deformableCloth(world, patch(world, 2, 2, 10, 0), 0.05, 0.5, Flags::VF_DD, 10, 1).setSpringStiffness(10);
}

void deformableRigid(World& world) {
    world.add(box(150, 25, 150), at(0, -42, 0), 0, 1);
    deformableCloth(world, patch(world, 4, 0, 20, 15), 0.05, 2, 0, 15, 0.5);
    for (int i = 0; i < 10; ++i) {
        world.add(box(1, 1, 1), at(0, 3 + 3 * i, 0), number(0.2));
    }
}

void deformableSelfCollision(World& world) {
    world.setGravity(number(9.8));
    world.add(box(150, 2.5, 150), at(0, -3.5, 0), 0, 4);
    for (const double height : {0.0, 0.1}) {
        btSoftBody* body = btSoftBodyHelpers::CreatePatch(world.info(), at(-0.6, height, -1.2), at(0.6, height, -1.2),
                                                          at(-0.6, height, 1.2), at(0.6, height, 1.2), 15, 30, 0, true);
        btSoftBody& added = deformableCloth(world, body, 0.02, 0.1, Flags::SDF_RDN | Flags::VF_DD, 2, 0.2);
        added.setSpringStiffness(4);
        added.setSelfCollision(true);
    }
}

void splitImpulse(World& world) {
    world.setGravity(50);
    world.add(box(150, 25, 150), at(0, -32, 0), 0, 1);
    deformableCloth(world, patch(world, 4, 0, 10, 15), 0.015, 1, 0, 30, 1);
    world.add(box(1, 1, 1), at(0, 0.7, 0), number(0.2));
}

void tetrahedra(World& world, double height, double half) {
    btSoftBody* body = block(world, at(0, height, 0), half, 3);
    body->getCollisionShape()->setMargin(number(0.01));
    body->setTotalMass(1);
    body->m_cfg.kKHR = body->m_cfg.kCHR = 1;
    body->m_cfg.kDF = number(0.5);
    body->m_cfg.collisions = Flags::SDF_RD | Flags::SDF_RDF;
    body->initializeDmInverse();
    body->m_tetraScratches.resizeNoInitialize(body->m_tetras.size());
    body->m_tetraScratchesTn.resizeNoInitialize(body->m_tetras.size());
    world.addDeformable(body, 0, 0);
    world.addForce(*body, std::make_unique<btDeformableNeoHookeanForce>(number(8), number(3), number(0.02)));
}

void volumetricDeformable(World& world) {
    world.add(box(150, 25, 150), at(0, -25, 0), 0, 1);
    tetrahedra(world, 4, 2);
    world.add(box(1, 1, 1), at(0, 9, 0), number(0.2));
}

void pinch(World& world) {
    world.add(box(150, 25, 150), at(0, -25, 0), 0, 1);
    tetrahedra(world, 4, 2);
    for (const double side : {-1.0, 1.0}) {
        world.add(box(3, 3, 0.5), at(0.5, 3, 4 * side), 1).setLinearVelocity(at(0, 0, -2 * side));
    }
}

/// Not one of theirs, as those above.
void deformableClothOnMesh(World& world) {
    wavyGround(world);
    deformableCloth(world, patch(world, 4, -8, 20, 0), 0.1, 2, Flags::SDF_RDN, 100, 1);
}

constexpr std::array demos{
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
    SoftDemo{"ClusterDeform", false, clusterDeform},
    SoftDemo{"ClusterCollide1", false, clusterCollide1},
    SoftDemo{"ClusterCollide2", false, clusterCollide2},
    SoftDemo{"ClusterSocket", false, clusterSocket},
    SoftDemo{"ClusterHinge", false, clusterHinge},
    SoftDemo{"ClusterCombine", false, clusterCombine},
    SoftDemo{"ClusterRobot", false, clusterRobot},
    SoftDemo{"ClusterStackSoft", false, clusterStackSoft},
    SoftDemo{"ClusterStackMixed", false, clusterStackMixed},
    SoftDemo{"TetraCube", false, tetraCube},
    SoftDemo{"tetrahedra on a mesh by nodes", false, tetraCubeByNodes},
    SoftDemo{"cloth on a mesh by nodes", false, clothByNodes},
    SoftDemo{"ClothFriction", true, clothFriction},
    SoftDemo{"DeformableClothAnchor", true, deformableClothAnchor},
    SoftDemo{"DeformableContact", true, deformableContact},
    SoftDemo{"DeformableRigid", true, deformableRigid},
    SoftDemo{"DeformableSelfCollision", true, deformableSelfCollision},
    SoftDemo{"SplitImpulse", true, splitImpulse},
    SoftDemo{"VolumetricDeformable", true, volumetricDeformable},
    SoftDemo{"Pinch", true, pinch},
    SoftDemo{"deformable cloth on a mesh", true, deformableClothOnMesh},
};

}  // namespace

std::span<const SoftDemo> softDemos() {
    return demos;
}

}  // namespace grapeshot::bench
