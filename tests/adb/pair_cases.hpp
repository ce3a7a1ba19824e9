// Pairs of trees with poses, and what it means that two decisions are the same.
#pragma once

#include <vector>

#include <grapeshot/adb/query.hpp>
#include <scenes/shapes.hpp>

namespace grapeshot::test {

struct PairCase {
    Tree a;
    Tree b;
    std::vector<Pose> poses;
};

/// Bumpy on bumpy, knot on gear, and a third pair of the three, in Zachmann poses.
struct ThreeMeshes {
    scenes::Mesh bumpy, knot, gear;
};
std::vector<PairCase> pairCases(const ThreeMeshes& meshes, int distances, int perDistance, std::uint64_t seed);

/// The same surface in another frame: `frame` takes the old coordinates to the new ones. Built anew.
Tree moved(const Tree& tree, const Pose& frame);

/// To the last bit.
bool same(const Decision& a, const Decision& b);

}  // namespace grapeshot::test
