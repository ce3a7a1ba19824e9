// Questions that do not come as `decide` asks them: other pairs each time, poses along a path, one pose again and
// again; and what the slowest of its own cost.
#pragma once

#include <vector>

#include <report/report.hpp>

#include "named_tree.hpp"

namespace grapeshot::bench {

/// What must hold of the answers.
struct WorkloadCheck {
    double disagreements = 0;  ///< of the exact answers with FCL's, beyond the borderline
    double uncertain = 0;      ///< exact answers that do not call themselves certain
    double poses = 0, colliding = 0;
};

/// Work units per question on Zachmann's and on grazing poses, and of all meshes together; no times.
[[nodiscard]] std::vector<report::Row> workRows(const std::vector<TreeOf>& meshes, int zachmann, int grazing,
                                                std::uint64_t seed, WorkloadCheck& check);

/// Pairs of different meshes. @param meshes at least two
[[nodiscard]] std::vector<report::Row> unlikeRows(const std::vector<TreeOf>& meshes, int questions, int repetitions,
                                                  std::uint64_t seed, WorkloadCheck& check);

/// Two copies of a mesh, one on smooth paths, in order, with and without the last witness tried first.
[[nodiscard]] std::vector<report::Row> coherentRows(const TreeOf& mesh, int steps, int repetitions, std::uint64_t seed,
                                                    WorkloadCheck& check);

/// Each pose `replays` times one after the other: everything is in the caches and every branch foreseen, which is good
/// for the exact traversal above all. Beside it, as many different poses, shuffled.
[[nodiscard]] std::vector<report::Row> hotRows(const TreeOf& mesh, int poses, int replays, int repetitions,
                                               std::uint64_t seed, WorkloadCheck& check);

}  // namespace grapeshot::bench
