// A mesh against any convex shape, by Bullet's own GJK and EPA on each candidate triangle.
#pragma once

#include <BulletCollision/CollisionShapes/btConvexShape.h>
#include <LinearMath/btTransform.h>

#include <cstdint>
#include <vector>

#include <grapeshot/narrowphase/local_contacts.hpp>
#include <grapeshot/plugin/precision.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

/// Contacts of the mesh (A) with the convex solid, its margin being part of it; frame of the mesh. Appended to `out`.
/// GJK gives one point of a face that lies on another; corners of polyhedra are asked too, the rest comes in later
/// steps. Returns the work: one unit for four triangles or corners, which cost about as much as 16 elsewhere.
std::uint64_t gjkContacts(const MeshModel& mesh, const btConvexShape& convex, const btTransform& inMesh,
                          float maxDistance, const LocalContactSettings& settings, std::vector<SurfaceContact>& out);

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
