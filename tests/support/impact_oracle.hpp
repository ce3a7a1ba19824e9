// The slow truth of impacts: when do triangles whose corners go on straight lines first touch? In double precision, by
// the roots of cubics, where the library advances along distances.
//
// This work is based on:
// Xavier Provot. Collision and self-collision handling in cloth model dedicated to design garments. Computer Animation
// and Simulation 1997 (coplanarity of four moving points)
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <grapeshot/core/mesh_view.hpp>

namespace grapeshot::test {

inline constexpr double noImpact = std::numeric_limits<double>::infinity();

/// Vertices at both ends of a step, which must stay where they are.
struct MovingMesh {
    std::span<const Triangle> triangles;
    std::span<const Eigen::Vector3f> before, now;
};

/// Two triangles, and the first time in the step at which a corner meets a face or an edge an edge; 0 if they overlap
/// at its start.
struct TriangleImpact {
    std::uint32_t a = 0, b = 0;
    double time = noImpact;
};
/// Of all pairs of triangles that meet, ascending (a, b).
std::vector<TriangleImpact> allImpacts(const MovingMesh& a, const MovingMesh& b);

/// The first of all pairs of triangles, `noImpact` if there is none. Much faster than to list them.
double meshImpact(const MovingMesh& a, const MovingMesh& b);

}  // namespace grapeshot::test
