// A mesh inside its own copy: two surfaces that are near each other everywhere, which no distribution can tell from two
// that meet.
#pragma once

#include <string>
#include <vector>

#include <report/report.hpp>
#include <support/poses.hpp>

#include "options.hpp"

namespace grapeshot::bench {

/// The copy, and where it is.
struct NestedShells {
    Tree inner;
    test::PoseSet set;
};
/// @param gap by which the copy's surface lies deeper, in diagonals of the box. Poses: a turn of up to 0.003 rad, and
/// up to twice the gap beside its place, so that about half of them touch
[[nodiscard]] NestedShells nestedIn(const Tree& tree, double gap, int poses, std::uint64_t seed);

/// The default settings on such poses, for gaps of 0.25, 1 and 5 %, against the exact traversal, and against FCL where
/// it is done before long. Returns the rows, one for each method and gap.
[[nodiscard]] std::vector<report::Row> nestedRows(const std::string& name, const Tree& tree, int poses, int repetitions,
                                                  std::uint64_t seed);

}  // namespace grapeshot::bench
