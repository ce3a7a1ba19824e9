// Pairs that are not two copies of a mesh, or hardly apart: where an estimate has it harder.
#pragma once

#include <vector>

#include <report/report.hpp>

#include "forecasts.hpp"
#include "named_tree.hpp"

namespace grapeshot::bench {

/// So many questions about pairs of different meshes, as `unlikePairs` has them.
[[nodiscard]] std::vector<report::Row> unlikePairsAtSteps(const std::vector<TreeOf>& meshes, int pairs,
                                                          std::uint64_t seed, ResumeCheck& check);

/// A mesh inside its own copy, whose surface lies 1 % of the size deeper: surfaces near each other everywhere.
[[nodiscard]] std::vector<report::Row> nestedShells(const TreeOf& mesh, int poses, std::uint64_t seed,
                                                    ResumeCheck& check);

}  // namespace grapeshot::bench
