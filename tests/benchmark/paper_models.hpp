// Shapes, trees and poses of the paper's experiment.
#pragma once

#include <string>
#include <vector>

#include <grapeshot/adb/reference/box.hpp>
#include <grapeshot/adb/reference/dop.hpp>
#include <grapeshot/adb/reference/tree.hpp>
#include <grapeshot/core/pose.hpp>

#include "meshes.hpp"
#include "options.hpp"

namespace grapeshot::bench {

/// The DOP-tree of this suite: 26 half-spaces need fewer tests and about the same time.
using PaperDop = reference::Dop<18>;

struct PaperModel {
    std::string name;
    scenes::Mesh mesh;  ///< longest side of the box 2 m, its middle in the origin
    reference::BoundedTree<reference::Box> boxes;
    reference::BoundedTree<PaperDop> dops;  ///< the same hierarchy
};

[[nodiscard]] PaperModel paperModel(NamedMesh named);

/// Those that tau, grid and pMin are fitted to, and those that are only shown. CAD parts and smooth bodies in both.
[[nodiscard]] std::vector<NamedMesh> fittedShapes(bool quick);
[[nodiscard]] std::vector<NamedMesh> shownShapes(bool quick);

/// B's middle moves away from A's along x; at each distance B turns once about y and, meanwhile, seven times about z.
struct Turns {
    std::vector<double> distances;         ///< m
    std::vector<std::vector<Pose>> poses;  ///< per distance
};
[[nodiscard]] Turns turns(const DistanceRange& range, int steps);

}  // namespace grapeshot::bench
