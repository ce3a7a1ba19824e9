// Pairs and poses that are not Zachmann's: where an estimate has it easier or harder, or the exact traversal does.
#pragma once

#include <vector>

#include <grapeshot/adb/tree.hpp>
#include <report/report.hpp>

#include "forecasts.hpp"
#include "meshes.hpp"

namespace grapeshot::bench {

struct TreeOf {
    std::string name;
    const Tree* tree;
};

/// So many pairs of different meshes, shuffled: each query finds other trees in the caches than the last one had.
[[nodiscard]] std::vector<report::Row> unlikePairs(const std::vector<TreeOf>& meshes, int pairs, int repetitions,
                                                   std::uint64_t seed, ResumeCheck& check);

/// A mesh inside its own copy, whose surface lies 1 % of the size deeper: surfaces near each other everywhere.
[[nodiscard]] std::vector<report::Row> nestedShells(const TreeOf& mesh, int poses, std::uint64_t seed,
                                                    ResumeCheck& check);

/// A copy that turns and swings in and out, in order, with the last witness tried first.
[[nodiscard]] std::vector<report::Row> coherentPath(const TreeOf& mesh, int steps, int repetitions, std::uint64_t seed);

/// The same pose again and again: everything is in the caches and every branch foreseen, which is good for the exact
/// traversal above all.
[[nodiscard]] std::vector<report::Row> hotReplay(const TreeOf& mesh, int poses, int replays, int repetitions,
                                                 std::uint64_t seed);

}  // namespace grapeshot::bench
