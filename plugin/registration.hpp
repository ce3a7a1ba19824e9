// The one call that switches a Bullet program.
#pragma once

#include <grapeshot/plugin/settings.hpp>
#include <grapeshot/plugin/status.hpp>

class btCollisionDispatcher;

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {

/// Puts our algorithms in place, in both tables of the dispatcher (contacts and queries) and for both orders of a pair:
/// btGImpactMeshShape, btGImpactMeshShapePart, btBvhTriangleMeshShape, btScaledBvhTriangleMeshShape,
/// btMultimaterialTriangleMeshShape and btHeightfieldTerrainShape against each other and against btStaticPlaneShape;
/// GImpact's meshes (and the others, see Settings::bvhConvexPairs) against all convex shapes; each child of a
/// btGImpactCompoundShape against whatever there is, by whoever serves the child. btCompoundShape stays with Bullet's
/// own recursion, which comes back if GImpact has taken its place. What stood there before is kept, serves whatever is
/// not ours and comes back with unregisterAlgorithms. Where nothing stood (Bullet's empty algorithm), other pairs with
/// a GImpact shape (a program's own concave shapes) get Bullet's GImpact algorithm, and are counted.
///
/// Call it before the first step: pairs that exist keep their algorithm until they part. Call it after
/// btGImpactCollisionAlgorithm::registerAlgorithm, which takes the same places. Again: changes the settings.
Status registerAlgorithms(btCollisionDispatcher* dispatcher, const Settings& settings = {}) noexcept;

/// Restores what stood there, as far as nobody else has taken the place since. Pairs that exist keep our algorithm
/// until they part. A dispatcher that is destroyed need not be unregistered, but then a few kilobytes stay behind until
/// another one is registered at its address.
Status unregisterAlgorithms(btCollisionDispatcher* dispatcher) noexcept;

/// Are all our algorithms in place? False after somebody else registered over them.
[[nodiscard]] bool isRegistered(const btCollisionDispatcher* dispatcher) noexcept;

}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
