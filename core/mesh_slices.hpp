// What is asked of a whole mesh before a tree stands on it, in slices: see sliced.hpp. The same as the functions of
// these names that do it at once.
#pragma once

#include <grapeshot/core/content_key.hpp>
#include <grapeshot/core/mesh_report.hpp>
#include <grapeshot/core/mesh_view.hpp>
#include <grapeshot/core/sliced.hpp>
#include <grapeshot/core/topology.hpp>

namespace grapeshot {

Sliced requireUsableInSlices(MeshView mesh);
Sliced inspectInSlices(MeshView mesh, MeshReport& report);
Sliced buildTopologyInSlices(MeshView mesh, Topology& topology);
Sliced contentKeyInSlices(MeshView mesh, ContentKey& key);
Sliced sameContentInSlices(MeshView left, MeshView right, bool& same);

}  // namespace grapeshot
