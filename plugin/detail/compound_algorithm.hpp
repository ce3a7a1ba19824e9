// GImpact's compounds: an algorithm for each child, as Bullet's own recursion does for btCompoundShape.
//
// GImpact's own algorithm throws all children's contacts at one manifold and makes them anew in each step. Here each
// child goes to whoever serves it: convex shapes and meshes of ours keep their contacts.
#pragma once

#include <BulletCollision/CollisionDispatch/btActivatingCollisionAlgorithm.h>

#include <memory>

#include <grapeshot/plugin/precision.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

struct Context;
class ChildPairs;

/// At least one of the two shapes is a btGImpactCompoundShape; if both are, the children of the first meet the whole
/// second. The other may be anything that the dispatcher has an algorithm for against the children. Children and shapes
/// may be others in each step. As small as the pool wants it: see MeshCollisionAlgorithm.
class CompoundAlgorithm final : public btActivatingCollisionAlgorithm {
  public:
    /// @throws std::bad_alloc
    CompoundAlgorithm(const btCollisionAlgorithmConstructionInfo& info, std::shared_ptr<Context> context, bool query);
    CompoundAlgorithm(const CompoundAlgorithm&) = delete;
    CompoundAlgorithm& operator=(const CompoundAlgorithm&) = delete;
    ~CompoundAlgorithm() override;

    void processCollision(const btCollisionObjectWrapper* body0, const btCollisionObjectWrapper* body1,
                          const btDispatcherInfo& info, btManifoldResult* result) noexcept override;
    btScalar calculateTimeOfImpact(btCollisionObject*, btCollisionObject*, const btDispatcherInfo&,
                                   btManifoldResult*) noexcept override {
        return 1;
    }
    void getAllContactManifolds(btManifoldArray& manifolds) noexcept override;

  private:
    std::shared_ptr<ChildPairs> m_pairs;  // shared with `processCollision` while it runs
};
static_assert(sizeof(CompoundAlgorithm) <= 64);

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
