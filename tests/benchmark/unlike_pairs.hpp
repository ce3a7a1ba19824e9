// Pairs of different meshes, shuffled: each question finds other trees in the caches than the last one left there.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include <grapeshot/core/pose.hpp>

#include "named_tree.hpp"

namespace grapeshot::bench {

struct UnlikePairs {
    struct Question {
        std::size_t pair;
        Pose pose;
    };
    std::vector<std::pair<std::size_t, std::size_t>> pairs;  ///< meshes by index, never twice the same
    std::vector<Question> questions;

    /// Those about one pair, by index.
    [[nodiscard]] std::vector<std::size_t> of(std::size_t pair) const;
    [[nodiscard]] std::vector<Pose> poses(const std::vector<std::size_t>& of) const;
};

/// Zachmann's procedure for each ordered pair of the meshes, as many of each; `count` in all, in random order.
[[nodiscard]] UnlikePairs unlikePairs(const std::vector<TreeOf>& meshes, std::size_t count, std::uint64_t seed);

}  // namespace grapeshot::bench
