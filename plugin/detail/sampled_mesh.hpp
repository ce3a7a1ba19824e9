// What stands in for a mesh whose tree is not built yet: some of its triangles, each wide enough to overlap the next.
#pragma once

#include <cstddef>
#include <span>

#include <grapeshot/plugin/detail/shape_mesh.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

/// Triangles of a stand-in. Its model costs about 4,000 work units, whatever the mesh.
inline constexpr std::size_t sampledShapeTriangles = 256;

/// One of every n triangles, three times as wide as its share of the surface, held within the box of all that were
/// sampled. Bad ones are left out; without a good one it is empty. An open mesh: it holds bodies on either side, where
/// the surface is smooth between two samples; its triangles are not the shape's.
[[nodiscard]] ShapeMesh sampledMesh(std::span<const PartSource> sources);

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
