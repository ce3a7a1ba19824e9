// The pose sets of `decide` and `anytime`: two copies of each reported mesh.
#pragma once

#include <vector>

#include <grapeshot/adb/tree.hpp>
#include <support/poses.hpp>

namespace grapeshot::bench {

inline constexpr int zachmannDistances = 12;

[[nodiscard]] inline test::PoseSet zachmannSet(const Tree& tree, int count, std::uint64_t seed) {
    return test::zachmannPoses(tree, tree, zachmannDistances, (count + zachmannDistances - 1) / zachmannDistances,
                               seed);
}

/// Just clear or just touching, by 0.15, 0.5 and 1.5 % of the box's diagonal; shuffled. `distances` are the gaps, as
/// parts of the diagonal.
[[nodiscard]] test::PoseSet grazingSet(const Tree& tree, int count, std::uint64_t seed);

}  // namespace grapeshot::bench
