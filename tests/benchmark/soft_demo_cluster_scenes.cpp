#include "soft_demo_parts.hpp"

#include <array>
#include <cmath>

namespace grapeshot::bench::demo {

namespace {

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

constexpr std::array scenes{
    SoftDemo{"ClusterDeform", false, clusterDeform},         SoftDemo{"ClusterCollide1", false, clusterCollide1},
    SoftDemo{"ClusterCollide2", false, clusterCollide2},     SoftDemo{"ClusterSocket", false, clusterSocket},
    SoftDemo{"ClusterHinge", false, clusterHinge},           SoftDemo{"ClusterCombine", false, clusterCombine},
    SoftDemo{"ClusterRobot", false, clusterRobot},           SoftDemo{"ClusterStackSoft", false, clusterStackSoft},
    SoftDemo{"ClusterStackMixed", false, clusterStackMixed}, SoftDemo{"TetraCube", false, tetraCube},
};

}  // namespace

std::span<const SoftDemo> clusterScenes() {
    return scenes;
}

}  // namespace grapeshot::bench::demo
