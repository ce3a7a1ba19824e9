// How much volume two bounding volumes share, by their sizes and the distance of their middles alone.
//
// This work is based on:
// Gabriel Zachmann. Collision Detection as a Fundamental Technology in VR Based Product Engineering. 2007, section 6.5
#pragma once

#include <Eigen/Core>

#include <grapeshot/adb/reference/box.hpp>

namespace grapeshot::reference {

/// What a node says of its size.
struct Extent {
    Eigen::Vector3d sides = Eigen::Vector3d::Zero();  ///< of its box, longest first, m
    double volume = 0;                                ///< of the box, m^3
    double meanSide = 0;                              ///< of a cube of that volume, m
    double radius = 0;                                ///< of the ball around the box; of the volume itself if a sphere
};

/// No side of a node's box counts as shorter than this part of its longest: flat pieces of surface have boxes without
/// volume, which leave nothing to divide by.
inline constexpr double thinnestSide = 0.01;

/// The box about the same middle with no side too thin.
[[nodiscard]] Box thickened(const Box& box);
/// Of a box that is thick enough.
[[nodiscard]] Extent extentOf(const Box& box);

/// max(V1, V2, V3) of equal boxes at this distance of their middles, not necessarily aligned; called an upper bound
/// over all alignments, which holds for cubes only.
[[nodiscard]] double equalBoxesVolume(const Eigen::Vector3d& sidesLongestFirst, double distance);

/// Of two balls.
[[nodiscard]] double lensVolume(double radiusA, double radiusB, double distance);

/// Sizes (radii) that differ by more than this factor take the balls instead of the boxes; the paper leaves it open.
inline constexpr double similarSizes = 2;

/// The one or the other, at most the smaller volume of both boxes.
[[nodiscard]] double intersectionVolume(const Extent& a, const Extent& b, double distance);

}  // namespace grapeshot::reference
