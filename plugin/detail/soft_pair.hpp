// What SoftAlgorithm does, behind its pointer: whose pair it is, what it may cost, and what is told of it.
#pragma once

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>

#include <memory>

#include <grapeshot/plugin/detail/soft_rigid_pair.hpp>
#include <grapeshot/plugin/detail/soft_soft_pair.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

/// Work units that a pair with a soft body may have in a step whatever the frame's budget.
inline constexpr std::uint64_t softSlice = 256;

/// What the next soft pair may have: they take it from the frame when their turn comes.
[[nodiscard]] Budget softBudget(Context& context);
void reportSoftPair(Context& context, const btCollisionObject& first, const btCollisionObject& second,
                    const SoftPairResult& result, const Budget& budget);

class SoftPair {
  public:
    SoftPair(btDispatcher& dispatcher, std::shared_ptr<Context> context);
    ~SoftPair();
    SoftPair(const SoftPair&) = delete;
    SoftPair& operator=(const SoftPair&) = delete;

    void process(const btCollisionObjectWrapper& body0, const btCollisionObjectWrapper& body1,
                 const btDispatcherInfo& info, btManifoldResult& result);
    void collectManifolds(btManifoldArray& manifolds) const;
    /// Those of the last step that the body has a part in.
    void appendContacts(const btSoftBody& body, std::vector<SoftContact>& contacts) const;

  private:
    void delegate(const btCollisionObjectWrapper& body0, const btCollisionObjectWrapper& body1,
                  const btDispatcherInfo& info, btManifoldResult& result);
    void dropDelegate();
    void processMesh(btSoftBody& soft, const btCollisionObjectWrapper& rigid, const btDispatcherInfo& info);
    void processSoft(btSoftBody& first, btSoftBody& second, btScalar timeStep);

    btDispatcher& m_dispatcher;
    std::shared_ptr<Context> m_context;
    std::uint64_t m_step = 0;
    std::unique_ptr<SoftRigidPair> m_rigid;
    std::unique_ptr<SoftSoftPair> m_soft;
    btCollisionAlgorithm* m_delegate = nullptr;
};

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
