// The slow truth of impacts: when do triangles whose corners go on straight lines first touch? In double precision, by
// the roots of cubics, where the library advances along distances.
//
// This work is based on:
// Xavier Provot. Collision and self-collision handling in cloth model dedicated to design garments. Computer Animation
// and Simulation 1997 (coplanarity of four moving points)
#pragma once

#include <limits>
#include <span>
#include <vector>

#include <grapeshot/core/mesh_view.hpp>
#include <support/oracle.hpp>

namespace grapeshot::test {

inline constexpr double noImpact = std::numeric_limits<double>::infinity();

/// First time in [from, to] at which a corner meets a face or an edge an edge; `from` if they overlap then.
double triangleImpact(const Corners& beforeA, const Corners& nowA, const Corners& beforeB, const Corners& nowB,
                      double from = 0, double to = 1);

/// Vertices at both ends of a step.
struct MovingMesh {
    std::span<const Triangle> triangles;
    std::vector<Eigen::Vector3d> before, now;
};
/// Of all pairs of triangles, `noImpact` if there is none.
double meshImpact(const MovingMesh& a, const MovingMesh& b);

}  // namespace grapeshot::test
