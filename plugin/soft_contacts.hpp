// What Bullet cannot do for soft bodies: collide with themselves, and tell what they touch.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include <grapeshot/plugin/settings.hpp>
#include <grapeshot/plugin/status.hpp>

class btCollisionDispatcher;
class btCollisionObject;
class btSoftBody;

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {

/// How a soft body collides with itself.
struct SelfCollision {
    /// At which two layers touch, m: > 0; 0: twice the body's margin.
    float thickness = 0;
    /// m, >= 0: triangles whose centroids were at most so far apart at rest are left out, beside those that are within
    /// one and a half times the thickness along the surface. Makes the search of fine meshes faster; wrong for bodies
    /// that are folded when they are first seen.
    float exclusion = 0;
    /// m, >= 0: of contacts nearer to each other than about this on both layers one is enough. 0: all, under a budget
    /// one per half an edge. Larger: a fine surface costs less, and what keeps it apart is a coarser body.
    float spacing = 0;
};

/// From the next dispatch on, nodes and edges of the body stay on their side of its own faces. The dispatcher must be a
/// Dispatcher, which has the hook for that (with any other this is ok and nothing happens: it cannot be told from ours
/// before its first dispatch). In a btDeformableMultiBodyDynamicsWorld (bodies with SDF_RD) Bullet has its own for
/// bodies with VF_DD and setSelfCollision(true): leave that false, or contacts are doubled. Costs a search of the body
/// against itself in every step, within the frame's budget. Again: changes the settings.
/// Call removeSelfCollision before the body is destroyed; while it is in no world it is left alone.
Status addSelfCollision(btCollisionDispatcher* dispatcher, btSoftBody* body, const SelfCollision& how = {}) noexcept;
/// @return badArgument if it was not added
Status removeSelfCollision(btCollisionDispatcher* dispatcher, const btSoftBody* body) noexcept;

/// One contact of a soft body in the last step, world frame, as it was before the solver.
struct SoftContact {
    const btCollisionObject* other = nullptr;           ///< the body itself if it touches itself
    std::array<int, 3> nodes{-1, -1, -1};               ///< of the soft body; -1: none
    std::array<float, 3> weights{};                     ///< of the nodes; their sum is 1
    int triangle = -1;                                  ///< of a mesh, in the order of its triangles; of a soft body -1
    std::array<int, 3> otherNodes{-1, -1, -1};          ///< of a soft body; of a mesh -1
    std::array<float, 3> otherWeights{};                ///< of these; of a mesh 0
    Eigen::Vector3f normal = Eigen::Vector3f::UnitY();  ///< unit, to the soft body
    float distance = 0;    ///< at the begin of the step, margins not included, m; negative: on the wrong side
    float predicted = 0;   ///< at its end, without contacts
    bool passing = false;  ///< it would have passed through, or has
};

/// Contacts of the body with meshes and soft bodies (and itself) in the last step. Those that Bullet's own algorithms
/// handle are not among them. Empty if the dispatcher is not registered or out of memory.
[[nodiscard]] std::vector<SoftContact> contactsOf(const btCollisionDispatcher* dispatcher,
                                                  const btSoftBody* body) noexcept;

/// The nearest points of a soft body and another body, world frame.
struct ClosestFeatures {
    Status status = Status::badArgument;
    bool found = false;                    ///< something is within the distance
    float distance = 0;                    ///< m, margins not included; 0: they intersect
    std::array<int, 3> nodes{-1, -1, -1};  ///< the soft body's triangle
    int triangle = -1;                     ///< the other's: of its mesh, or of its soft surface; of a convex shape -1
    Eigen::Vector3f onSoft = Eigen::Vector3f::Zero();
    Eigen::Vector3f onOther = Eigen::Vector3f::Zero();
};

/// As the bodies stand now. @param other a soft body, or a body with meshes or convex shapes (also as children of
/// compounds), the margins of the latter being part of them; unsupportedShape else. @param maxDistance m, > 0. Builds
/// what the bodies need (some 5 us a triangle), each time: for tools and tests rather than for every frame.
[[nodiscard]] ClosestFeatures closestFeatures(const btSoftBody& soft, const btCollisionObject& other,
                                              float maxDistance) noexcept;

}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
