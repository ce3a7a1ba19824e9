// Contact regions from pieces of the curve in which two surfaces cross: where they push each other apart, how far, and
// how sure that is.
//
// This work is based on:
// Jan Klein, Gabriel Zachmann. ADB-Trees: Controlling the Error of Time-Critical Collision Detection. VMV 2003 (future
// work: contacts from what the nodes know)
#pragma once

#include <span>
#include <vector>

#include <grapeshot/adb/crossing.hpp>
#include <grapeshot/core/random.hpp>
#include <grapeshot/narrowphase/contact_regions.hpp>

namespace grapeshot {

/// A's frame, metres.
struct CrossingRegion {
    Eigen::Vector3f position = Eigen::Vector3f::Zero();  ///< mean of the curve
    Eigen::Vector3f normal = Eigen::Vector3f::UnitY();   ///< unit, on B pointing to A: the way A is pushed
    float extent = 0;                                    ///< of the curve about the position, root mean square
    /// Of the penetration along the normal, estimated from the curve, m: exact for two paraboloids of one curvature, 5
    /// % too much for balls that are in each other by a fifth of their radius.
    float depth = 0;
    float length = 0;         ///< of the curve, expected: the region's weight
    float rate = 0;           ///< sum over its pieces that are not proven
    std::uint64_t steps = 0;  ///< its part of all steps
    /// P(the surfaces cross here), by the calibration for its rate and steps; 1 only if proven.
    float probability = 0;
    float positionError = 0;  ///< standard deviation of the position, by what its pieces leave open
    bool proven = false;      ///< a pair of triangles that intersects was found
    TrianglePair pair;        ///< the one with the longest piece of the curve, if proven
};

/// Contact regions as contact_regions.hpp has them, for pieces without depth and with an extent. Pieces are connected
/// if they are no farther apart than the spacing and both their extents; those whose directions are within the normal
/// cone of the mean direction of all that are connected are a region, as far as they are connected among themselves;
/// what is left over is grouped again. (Those connected with the longest one, if there are several such sets. If no
/// direction is within the cone of the mean, the cone is about the longest one's.) By decreasing expected length;
/// deterministic for a given order of input. A piece that pushes no way (direction 0), or with a number that is none,
/// belongs to no region. O(n^2) at worst, but sixteen at a time, and with blocks of sixteen left out that are too far
/// away.
/// @param steps that the pieces are of (Crossing::work)
void groupCrossing(std::span<const CurvePiece> pieces, std::uint64_t steps, const RegionSettings& settings,
                   const Calibration& calibration, std::vector<CrossingRegion>& out);

/// Which of them to believe. mostLikely: those with a probability of at least one half. sample: each with its
/// probability, and then at a place drawn from what is left open. The draws belong to the key: take as its
/// `step` the one in which the pair came so near that it could not be told any more, and keep it until the regions are
/// proven; then contacts move with their estimates, and do not flicker. Regions are told apart by their order, so an
/// episode in which their order changes swaps their draws.
/// `regions` is filtered in place.
void takeRegions(Answer answer, const RandomKey& episode, std::vector<CrossingRegion>& regions);

}  // namespace grapeshot
