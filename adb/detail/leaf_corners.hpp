// A leaf's triangles, out of their lanes.
#pragma once

#include <Eigen/Core>

#include <grapeshot/adb/tree.hpp>

namespace grapeshot::detail {

[[nodiscard]] inline Eigen::Vector3d cornerOf(const LeafBlock& leaf, int corner, int lane) {
    return {leaf.corner[corner][0][lane], leaf.corner[corner][1][lane], leaf.corner[corner][2][lane]};
}

}  // namespace grapeshot::detail
