// What the scenes after Bullet's demos of soft bodies are made of, and their lists.
#pragma once

#include <span>

#include "soft_demo_scenes.hpp"

namespace grapeshot::bench::demo {

using Flags = btSoftBody::fCollision;
using World = SoftDemoWorld;

inline constexpr btScalar pi = SIMD_PI;

inline btScalar number(double value) {
    return static_cast<btScalar>(value);
}

inline btVector3 at(double x, double y, double z) {
    return {number(x), number(y), number(z)};
}

/// A number of -1..1.
[[nodiscard]] double drawn(std::uint32_t index);

[[nodiscard]] btBoxShape* box(double x, double y, double z);
void flatGround(World& world);
/// A mesh.
void wavyGround(World& world);
/// A square of cloth. @param fixed corners, as CreatePatch has them
[[nodiscard]] btSoftBody* patch(World& world, double half, double height, int nodes, int fixed,
                                const btVector3& place = {0, 0, 0});
[[nodiscard]] btSoftBody* torus(World& world);
/// In place of Bullet's rabbit.
[[nodiscard]] btSoftBody* lumpyBall(World& world);
[[nodiscard]] btSoftBody* ball(World& world, const btVector3& place);
/// A ball whose volume is kept, added.
btSoftBody& keepingVolume(World& world, const btVector3& place);
/// A block of cells^3 cubes of six tetrahedra each.
[[nodiscard]] btSoftBody* block(World& world, const btVector3& middle, double half, int cells);

void bend(btSoftBody& body, double stiffness);
void turn(btSoftBody& body, double x, double y, double z, const btVector3& place);
/// Rigid bodies of three kinds above each other.
void stack(World& world, int count);
void plate(World& world, double mass, double height);
void stair(World& world, const btVector3& origin, const btVector3& half, int count);

/// In btSoftRigidDynamicsWorld: bodies that collide by their nodes; by clusters.
[[nodiscard]] std::span<const SoftDemo> nodeScenes();
[[nodiscard]] std::span<const SoftDemo> clusterScenes();
/// In btDeformableMultiBodyDynamicsWorld.
[[nodiscard]] std::span<const SoftDemo> deformableScenes();

}  // namespace grapeshot::bench::demo
