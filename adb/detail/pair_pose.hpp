// A relative pose, prepared for the node-pair kernel.
#pragma once

#include <grapeshot/adb/tree.hpp>
#include <grapeshot/core/pose.hpp>

namespace grapeshot::detail {

/// Plain floats, so that code compiled per instruction set may read them.
struct PairPose {
    float row[3][4];    ///< of the rotation, and the translation in m behind it
    float pairs[3][8];  ///< [row]: entry (row, column) and entry (column, row), column by column; two more
    float perLength;    ///< 1/m, a power of two: about one over both radii, which keeps sixth powers within range
    float areaOctaves;  ///< 4 log2 of perLength: makes the sum of two areas' logarithms one of numbers without unit
    /// Boxes touch if their margin (see node_pair.hpp) is not below this: minus the distance asked for, minus what
    /// rounding and a rotation that is not quite orthonormal can take away. m
    float threshold;
};

enum class PoseVerdict {
    usable,
    apart,    ///< the balls about the origins are already farther apart than the distance
    invalid,  ///< not finite or not rigid
};

/// @param maxDistance m, >= 0 (not NaN).
PoseVerdict prepare(const Pose& bInA, float radiusA, float radiusB, float maxDistance, PairPose& out) noexcept;

}  // namespace grapeshot::detail
