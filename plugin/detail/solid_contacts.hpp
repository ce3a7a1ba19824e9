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

#include <grapeshot/narrowphase/solid_update.hpp>
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

/// One step of the mesh against it, `pose` being `inMesh`: see updateSolid.
PairResult updateSolid(const MeshModel& mesh, const PlacedSolid& solid, const Pose& pose, const PairSettings& settings,
                       const Budget& budget, PairState& state);

/// Appends contacts within `settings.maxDistance`, the mesh being A; frame of the mesh. Returns the work, in units.
std::uint64_t solidContacts(const MeshModel& mesh, const PlacedSolid& solid, const LocalContactSettings& settings,
                            const Budget& budget, std::vector<SurfaceContact>& out);

/// Does it take functions of Bullet's, which may not be called from two threads? Not for planes, boxes, spheres and
/// capsules.
[[nodiscard]] bool asksBullet(const btCollisionShape& solid);

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
