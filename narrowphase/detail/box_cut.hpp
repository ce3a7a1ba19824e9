// A mesh that goes right through a box: none of its corners tells the way out, the curve of the cut does.
#pragma once

#include <cstdint>
#include <vector>

#include <grapeshot/narrowphase/convex_contacts.hpp>

namespace grapeshot::detail {

/// Does the mesh's box reach beyond two opposite faces of the box, and meet it along the other axes?
[[nodiscard]] bool canReachThrough(const MeshModel& mesh, const BoxSolid& box);

/// Its twelve triangles, about its own middle. The last few of a thread are kept, so it is valid until some others have
/// been asked for.
[[nodiscard]] const MeshModel& modelOfBox(const Eigen::Vector3f& half);

/// Contacts as between two meshes, of the box's own twelve triangles; for where boxContacts found none. Appended to
/// `out`. Returns the work, 0 if the mesh cannot reach through the box.
std::uint64_t boxCutContacts(const MeshModel& mesh, const BoxSolid& box, std::vector<SurfaceContact>& out,
                             LeafChoice* choice = nullptr);

}  // namespace grapeshot::detail
