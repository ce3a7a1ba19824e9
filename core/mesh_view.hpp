// A triangle mesh as the caller keeps it.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>

namespace grapeshot {

/// Corner indices of one triangle, counter-clockwise seen from outside.
using Triangle = std::array<std::uint32_t, 3>;

/// Borrowed vertices and triangles; owns nothing, copies nothing. Vertices are in the body's own frame, in metres (or
/// whatever unit the whole scene uses). The spans must outlive every call they are passed to, not longer.
struct MeshView {
    std::span<const Eigen::Vector3f> vertices;
    std::span<const Triangle> triangles;
};

}  // namespace grapeshot
