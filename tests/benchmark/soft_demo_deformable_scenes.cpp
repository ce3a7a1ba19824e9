#include "soft_demo_parts.hpp"

#include <BulletSoftBody/btDeformableNeoHookeanForce.h>

#include <array>
#include <memory>

namespace grapeshot::bench::demo {

namespace {

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

constexpr std::array scenes{
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

std::span<const SoftDemo> deformableScenes() {
    return scenes;
}

}  // namespace grapeshot::bench::demo
