// A mesh against a plane or a convex shape of Bullet's.
//
// Margins: a box's, sphere's and capsule's is inside its size, so their surface is what it says; a convex hull's and
// most others' is a ball around it. Either way the contacts here are with the solid's true surface, its margin
// included; only the mesh's margin remains to be subtracted. A plane's margin remains too: it is added as GImpact does.
#pragma once

#include <BulletCollision/CollisionShapes/btCollisionShape.h>
#include <LinearMath/btTransform.h>

#include <cstdint>
#include <vector>

#include <grapeshot/narrowphase/local_contacts.hpp>
#include <grapeshot/plugin/precision.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

/// Plane or convex shape (see isSolid), seen from a mesh.
struct PlacedSolid {
    const btCollisionShape* shape = nullptr;
    btTransform inMesh;  ///< the solid in the mesh's frame
};

/// What the solid's margin adds beyond its surface, m: 0 but for planes.
[[nodiscard]] btScalar marginBeyond(const btCollisionShape& solid);
/// Half the diagonal of its box and the smallest of its extents, m; infinite for planes.
struct SolidSize {
    float halfDiagonal = 0;
    float thickness = 0;
};
[[nodiscard]] SolidSize sizeOf(const btCollisionShape& solid);

/// Appends contacts within `maxDistance`, the mesh being A; frame of the mesh. Returns the work, in units.
std::uint64_t solidContacts(const MeshModel& mesh, const PlacedSolid& solid, float maxDistance,
                            const LocalContactSettings& settings, std::vector<SurfaceContact>& out);

/// Are they all there is in one step? The general convex case gathers them over several.
[[nodiscard]] bool isComplete(const btCollisionShape& solid);

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
