// What a leaf block looks like from outside: its box, and where its surroundings face.
//
// This work is based on:
// David Johnson, Elaine Cohen. Spatialized Normal Cone Hierarchies. I3D 2001 (local minima of the distance need normals
// that face each other)
#pragma once

#include <Eigen/Core>
#include <vector>

#include <grapeshot/narrowphase/mesh_model.hpp>

namespace grapeshot::detail {

/// By leaf block. The cone holds the normals of the leaf's triangles and of all that share a corner with one, so that
/// it holds the directions in which any of the leaf's corners, edges and faces can be touched, with some to spare.
[[nodiscard]] std::vector<LeafShape> leafShapes(const Tree& tree, const Topology& topology,
                                                const std::vector<Eigen::Vector3f>& triangleNormals,
                                                const std::vector<std::uint16_t>& traits);

/// Can a corner, edge or face of A's leaf touch one of B's? Both axes in one frame. Sheets have two sides.
[[nodiscard]] inline bool faceEachOther(const LeafShape& a, const LeafShape& b, bool twoSided) {
    // cos(spreadA + spreadB); from a half turn on the sine is negative.
    const float sine = a.sinSpread * b.cosSpread + a.cosSpread * b.sinSpread;
    const float cosine = a.cosSpread * b.cosSpread - a.sinSpread * b.sinSpread;
    const float facing = -a.axis.dot(b.axis);
    return sine <= 0 || a.cosSpread <= -1 || b.cosSpread <= -1 || facing >= cosine || (twoSided && -facing >= cosine);
}

}  // namespace grapeshot::detail
