// Children of fast compounds: contacts ahead of time.
//
// Bullet's recursion into compounds only asks for children whose boxes overlap now. So beside it, and after it, the
// pairs of leaf children that do not overlap, but may within the coming step, are asked for contacts ahead; they have
// algorithms of ours, for as long as that is so.
#pragma once

#include <BulletCollision/CollisionDispatch/btActivatingCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btCollisionCreateFunc.h>

#include <memory>

#include <grapeshot/plugin/precision.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

struct Context;
class ChildrenAhead;

/// At least one of the two shapes is a btCompoundShape. What came before in the place of the table, Bullet's recursion
/// as a rule, is asked first. As small as the pool wants it: see MeshCollisionAlgorithm. A callback of the program's
/// that removes one of the bodies while Bullet's recursion goes on destroys it only afterwards.
class SweptCompoundAlgorithm final : public btActivatingCollisionAlgorithm {
  public:
    /// For pairs of the simulation.
    struct CreateFunc : btCollisionAlgorithmCreateFunc {
        explicit CreateFunc(Context& context) : m_context(context) {}
        btCollisionAlgorithm* CreateCollisionAlgorithm(btCollisionAlgorithmConstructionInfo& info,
                                                       const btCollisionObjectWrapper* body0,
                                                       const btCollisionObjectWrapper* body1) override;

      private:
        Context& m_context;
    };

    /// `recursion` becomes its own. @throws std::bad_alloc
    SweptCompoundAlgorithm(const btCollisionAlgorithmConstructionInfo& info, std::shared_ptr<Context> context,
                           btCollisionAlgorithm* recursion);
    SweptCompoundAlgorithm(const SweptCompoundAlgorithm&) = delete;
    SweptCompoundAlgorithm& operator=(const SweptCompoundAlgorithm&) = delete;
    ~SweptCompoundAlgorithm() override;

    void processCollision(const btCollisionObjectWrapper* body0, const btCollisionObjectWrapper* body1,
                          const btDispatcherInfo& info, btManifoldResult* result) override;
    btScalar calculateTimeOfImpact(btCollisionObject*, btCollisionObject*, const btDispatcherInfo&,
                                   btManifoldResult*) override {
        return 1;
    }
    void getAllContactManifolds(btManifoldArray& manifolds) override;

  private:
    std::shared_ptr<ChildrenAhead> m_children;  // shared with `processCollision` while it runs
};
static_assert(sizeof(SweptCompoundAlgorithm) <= 64);

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
