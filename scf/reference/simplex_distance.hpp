// Closest points of vertices, edges and faces.
//
// This work is based on:
// Christer Ericson. Real-Time Collision Detection. 2005, sections 5.1.5, 5.1.9
#pragma once

#include <Eigen/Core>
#include <array>

namespace grapeshot::scf::reference {

/// A closed point, segment or triangle.
struct Simplex {
    std::array<Eigen::Vector3d, 3> corners;
    int count = 1;  ///< 1 to 3
};

struct ClosestPoints {
    double distance = 0;  ///< m; exactly 0 if a segment runs through a triangle
    Eigen::Vector3d onA, onB;
    /// The smallest part of each simplex that the point lies on: a bit per corner.
    unsigned partOfA = 1;
    unsigned partOfB = 1;
};

/// Among equally close points those on the smaller parts.
[[nodiscard]] ClosestPoints closestPoints(const Simplex& a, const Simplex& b);

}  // namespace grapeshot::scf::reference
