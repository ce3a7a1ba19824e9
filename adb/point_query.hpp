// Questions of points, rays and boxes to one tree.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include <grapeshot/adb/tree.hpp>

namespace grapeshot {

struct ClosestPoint {
    Eigen::Vector3f point = Eigen::Vector3f::Zero();  ///< on the surface, mesh frame, m
    float distance = 0;                               ///< m, >= 0
    std::uint32_t triangle = noTriangle;
    std::uint8_t feature = 6;  ///< 0..2 corner, 3..5 edge, 6 face
};

/// The closest point of the surface within `maxDistance` (m), if any. Ties go to the lowest triangle index.
[[nodiscard]] std::optional<ClosestPoint> closestPoint(const Tree& tree, const Eigen::Vector3f& query,
                                                       float maxDistance);

struct RayHit {
    float t = 0;  ///< parameter along the direction
    std::uint32_t triangle = noTriangle;
    bool backFace = false;  ///< the ray leaves the solid here
};

/// First hit with 0 <= t <= maxT, either side. The direction need not be unit.
[[nodiscard]] std::optional<RayHit> castRay(const Tree& tree, const Eigen::Vector3f& origin,
                                            const Eigen::Vector3f& direction, float maxT);

/// Is the point inside the closed mesh (on it: unspecified)? By the solid angle's sign over crossings of three fixed
/// rays, majority; so one ray through an edge does no harm. For open meshes the answer means nothing.
[[nodiscard]] bool contains(const Tree& tree, const Eigen::Vector3f& point);

/// Indices of the leaf blocks whose boxes touch the box [lower, upper] (mesh frame, m); appended to `leaves` in tree
/// order.
void leavesInBox(const Tree& tree, const Eigen::Vector3f& lower, const Eigen::Vector3f& upper,
                 std::vector<std::uint32_t>& leaves);

/// Leaf blocks with a box corner x that satisfies normal . x <= offset (mesh frame; normal unit).
void leavesBelowPlane(const Tree& tree, const Eigen::Vector3f& normal, float offset,
                      std::vector<std::uint32_t>& leaves);

}  // namespace grapeshot
