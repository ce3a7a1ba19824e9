// The poses that a certificate holds for, unless the caller brings some.
//
// This work is based on:
// Gabriel Zachmann. Minimal Hierarchical Collision Detection. VRST 2002, section 6 (two bodies, a range of centre
// distances, random rotations)
// Ken Shoemake. Uniform Random Rotations. Graphics Gems III, 1992
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <grapeshot/adb/tree.hpp>
#include <grapeshot/core/pose.hpp>

namespace grapeshot {

/// "zachmann": for each pose one of twelve distances of the middles of the boxes, from 0.2 to 1.05 of the mean bounding
/// diameter (nearly always colliding to never), a uniform direction and a uniform rotation of B, all drawn anew. So the
/// poses are independent of each other. Pose i depends on the trees, the seed and i alone. O(vertices) + 0.5 us a pose.
[[nodiscard]] std::vector<Pose> certificationPoses(const Tree& a, const Tree& b, std::size_t count, std::uint64_t seed);

}  // namespace grapeshot
