// A part of space that a search of contacts looks at.
#pragma once

#include <Eigen/Core>

#include <grapeshot/narrowphase/mesh_model.hpp>

namespace grapeshot {

/// In a mesh's frame: a half-space normal . x <= offset, or a box.
struct SearchRegion {
    bool isBox = true;
    Eigen::Vector3f lower = Eigen::Vector3f::Zero(), upper = Eigen::Vector3f::Zero();
    Eigen::Vector3f normal = Eigen::Vector3f::Zero();
    float offset = 0;
    [[nodiscard]] static SearchRegion inBox(const Eigen::Vector3f& lower, const Eigen::Vector3f& upper) {
        return {true, lower, upper, Eigen::Vector3f::Zero(), 0};
    }
    [[nodiscard]] static SearchRegion belowPlane(const Eigen::Vector3f& normal, float offset) {
        return {false, Eigen::Vector3f::Zero(), Eigen::Vector3f::Zero(), normal, offset};
    }
    /// Never says no to a leaf of which a triangle touches the region.
    [[nodiscard]] bool touches(const LeafShape& leaf) const;
};

}  // namespace grapeshot
