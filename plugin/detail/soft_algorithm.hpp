// Bullet's algorithm object for pairs with a soft body.
#pragma once

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btCollisionCreateFunc.h>

#include <memory>

#include <grapeshot/plugin/precision.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

struct Context;
class SoftPair;

/// A soft body against a mesh. Looks at both in every step: what its flags keep from us goes to whoever was there
/// before. As small as the pool wants it: see AdbCollisionAlgorithm.
class SoftAlgorithm final : public btCollisionAlgorithm {
  public:
    /// @throws std::bad_alloc
    SoftAlgorithm(const btCollisionAlgorithmConstructionInfo& info, std::shared_ptr<Context> context);
    SoftAlgorithm(const SoftAlgorithm&) = delete;
    SoftAlgorithm& operator=(const SoftAlgorithm&) = delete;
    ~SoftAlgorithm() override;

    void processCollision(const btCollisionObjectWrapper* body0, const btCollisionObjectWrapper* body1,
                          const btDispatcherInfo& info, btManifoldResult* result) noexcept override;
    btScalar calculateTimeOfImpact(btCollisionObject*, btCollisionObject*, const btDispatcherInfo&,
                                   btManifoldResult*) noexcept override {
        return 1;
    }
    void getAllContactManifolds(btManifoldArray& manifolds) noexcept override;
    [[nodiscard]] const SoftPair& pair() const { return *m_pair; }

    class CreateFunc final : public btCollisionAlgorithmCreateFunc {
      public:
        explicit CreateFunc(Context& context) : m_context(context) {}
        btCollisionAlgorithm* CreateCollisionAlgorithm(btCollisionAlgorithmConstructionInfo& info,
                                                       const btCollisionObjectWrapper* body0,
                                                       const btCollisionObjectWrapper* body1) noexcept override;

      private:
        Context& m_context;
    };

  private:
    std::shared_ptr<SoftPair> m_pair;  // shared with `processCollision` while it runs
};
static_assert(sizeof(SoftAlgorithm) <= 64);

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
