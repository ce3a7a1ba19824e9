// A relative pose, prepared for the node-pair kernel.
#pragma once

#include <grapeshot/adb/tree.hpp>
#include <grapeshot/core/pose.hpp>

namespace grapeshot::detail {

/// Plain floats, so that code compiled per instruction set may read them.
struct alignas(64) PairPose {
    /// Four products of a 3 x 3 matrix at once: entry (row, column) of |R|, |R^T|, R and R^T in lanes 0..3, 4..7, 8..11
    /// and 12..15. Makes B's half extents those in A's frame, A's in B's frame, B's normals in A's frame, A's in B's.
    float turn[3][3][16];
    float rotation[3][3];  ///< [row][column]
    float translation[3];  ///< m
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
