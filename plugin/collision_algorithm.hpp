// The algorithm itself, for programs that fill a dispatcher's tables on their own.
#pragma once

#include <BulletCollision/CollisionDispatch/btActivatingCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btCollisionCreateFunc.h>

#include <memory>

#include <grapeshot/plugin/settings.hpp>
#include <grapeshot/plugin/status.hpp>

class btCollisionDispatcher;

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {

namespace detail {
struct Context;
class PairProcessor;
}  // namespace detail

/// One pair of shapes, at least one of them a mesh: against each other by Settings::method, or one against a plane or a
/// convex shape. Lives in the dispatcher's pool, whose slots have 192 bytes, unchecked: so everything is behind a
/// pointer.
class MeshCollisionAlgorithm : public btActivatingCollisionAlgorithm {
  public:
    /// `query`: made for contactTest and contactPairTest, without memory of earlier steps.
    MeshCollisionAlgorithm(const btCollisionAlgorithmConstructionInfo& info, std::shared_ptr<detail::Context> context,
                           bool query) noexcept;
    MeshCollisionAlgorithm(const MeshCollisionAlgorithm&) = delete;
    MeshCollisionAlgorithm& operator=(const MeshCollisionAlgorithm&) = delete;
    ~MeshCollisionAlgorithm() override;

    void processCollision(const btCollisionObjectWrapper* body0, const btCollisionObjectWrapper* body1,
                          const btDispatcherInfo& info, btManifoldResult* result) noexcept override;
    /// Always 1: nobody in Bullet asks. Fast bodies are caught by contacts ahead of time.
    btScalar calculateTimeOfImpact(btCollisionObject* body0, btCollisionObject* body1, const btDispatcherInfo& info,
                                   btManifoldResult* result) noexcept override;
    void getAllContactManifolds(btManifoldArray& manifolds) noexcept override;

    /// Looks at the two shapes when a pair is made: what is not ours goes to whoever was there before.
    class CreateFunc : public btCollisionAlgorithmCreateFunc {
      public:
        /// For one cell or more of a dispatcher's contact table, or (`query`) of its closest-point table. Must outlive
        /// the dispatcher's pairs. Not needed with registerAlgorithms.
        explicit CreateFunc(const Settings& settings = {}, bool query = false);
        CreateFunc(detail::Context& context, bool query) noexcept;
        btCollisionAlgorithm* CreateCollisionAlgorithm(btCollisionAlgorithmConstructionInfo& info,
                                                       const btCollisionObjectWrapper* body0,
                                                       const btCollisionObjectWrapper* body1) noexcept override;

      private:
        std::shared_ptr<detail::Context> m_own;  // null if the context owns this
        detail::Context* m_context;
        bool m_query;
    };

    /// For a Dispatcher; null: out of memory.
    [[nodiscard]] detail::PairProcessor* processor() const noexcept { return m_pair.get(); }

  private:
    std::shared_ptr<detail::PairProcessor> m_pair;  // shared with `processCollision` while it runs
};
static_assert(sizeof(MeshCollisionAlgorithm) <= 64);

/// By average-distribution trees.
class AdbCollisionAlgorithm final : public MeshCollisionAlgorithm {
  public:
    using MeshCollisionAlgorithm::MeshCollisionAlgorithm;

    class CreateFunc final : public MeshCollisionAlgorithm::CreateFunc {
      public:
        /// `settings` with Settings::method automatic or, if it was scf, adb.
        explicit CreateFunc(const Settings& settings = {}, bool query = false);
    };

    /// As registerAlgorithms, with Settings::method adb.
    static Status registerAlgorithm(btCollisionDispatcher* dispatcher) noexcept;
};

/// By stochastic closest features.
class ScfCollisionAlgorithm final : public MeshCollisionAlgorithm {
  public:
    using MeshCollisionAlgorithm::MeshCollisionAlgorithm;

    class CreateFunc final : public MeshCollisionAlgorithm::CreateFunc {
      public:
        /// `settings` with Settings::method scf.
        explicit CreateFunc(const Settings& settings = {}, bool query = false);
    };

    /// As registerAlgorithms, with Settings::method scf.
    static Status registerAlgorithm(btCollisionDispatcher* dispatcher) noexcept;
};

}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
