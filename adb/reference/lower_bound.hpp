// LB: how likely one collision cell holds a collision.
//
// This work is based on:
// Gabriel Zachmann. Collision Detection as a Fundamental Technology in VR Based Product Engineering. 2007, section 6.4
#pragma once

namespace grapeshot::reference {

/// (d_A + d_B) / (d_maxA + d_maxB), and 1 for two trees that are a leaf each.
[[nodiscard]] double depthBound(int depthA, int depthB, int maxDepthA, int maxDepthB);

/// How likely two planes intersect within a cube in which each has at least tau * MaxArea, both random otherwise. By
/// Monte Carlo, linear in between; 1 from tau = 1 on (figure 9: two diagonals).
[[nodiscard]] double planarBound(double tau);

/// The same for patches that bend: `halfAngle` (of the wider normal cone, rad) stands for cell side / radius of
/// curvature. All bending of a node may be in one of its cells, as at an edge, so it is not divided by the grid. Fitted
/// to pairs of spherical patches by Monte Carlo.
[[nodiscard]] double curvatureBound(double tau, double halfAngle);

}  // namespace grapeshot::reference
