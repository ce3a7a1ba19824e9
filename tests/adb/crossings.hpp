// What the tests of the crossing query have in common.
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include <grapeshot/adb/crossing.hpp>

#include "pair_cases.hpp"

namespace grapeshot::test {

/// Made once. None of these meshes is one that the calibration was fitted on.
const std::vector<PairCase>& crossingCases();

/// To the last bit, but for the work if it is the end that counts.
bool samePieces(const Crossing& a, const Crossing& b);
bool same(const Crossing& a, const Crossing& b);

/// All numbers are numbers and within what the header promises, and proven pieces come first.
testing::AssertionResult wellFormed(const Crossing& crossing);

std::vector<TrianglePair> provenPairs(const Crossing& crossing);
double totalLength(const Crossing& crossing);  ///< m

/// From nothing to the end.
Crossing exactCrossing(const Tree& a, const Tree& b, const Pose& pose);
Crossing crossingAfter(const Tree& a, const Tree& b, const Pose& pose, std::uint64_t work, float leaveOut = 0);

}  // namespace grapeshot::test
