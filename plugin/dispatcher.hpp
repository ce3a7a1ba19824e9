// A dispatcher that keeps a budget per frame, and computes the contacts of meshes on several threads.
#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>

#include <memory>
#include <type_traits>
#include <utility>

#include <grapeshot/plugin/registration.hpp>
#include <grapeshot/plugin/settings.hpp>
#include <grapeshot/plugin/statistics.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {

namespace detail {
struct Context;

/// What BasicDispatcher does, for any base: the phases before Bullet's pass in the constructor, the end of the dispatch
/// in the destructor.
class DispatchPhases {
  public:
    DispatchPhases(btCollisionDispatcher& dispatcher, btOverlappingPairCache* cache,
                   const btDispatcherInfo& info) noexcept;
    ~DispatchPhases();
    DispatchPhases(const DispatchPhases&) = delete;
    DispatchPhases& operator=(const DispatchPhases&) = delete;

  private:
    std::shared_ptr<Context> m_context;  // null: not registered
    bool m_nested = false;               // a callback of another dispatch has called this one
};
void beginFrame(const btCollisionDispatcher& dispatcher, int dispatches) noexcept;
}  // namespace detail

/// Takes the place of `Base`, a btCollisionDispatcher or a subclass with any constructor, which stays as it is: its
/// near callback, needsCollision (once more for each pair of ours) and so on are called as before. Registers our
/// algorithms (as registerAlgorithms does); call registerAlgorithms for other settings, of which frameBudget and
/// threads are for dispatchers like this alone.
///
/// A dispatch has three phases. Serial: the pairs of meshes are collected, with their poses. Parallel: their contacts
/// are computed, each pair within its slice of the budget. Serial: Bullet's own pass over all pairs, in its order;
/// pairs that are not ours go their usual way, ours write their contacts into manifolds and call the program's
/// callbacks. What the first phase could not foresee (children of compounds; pairs that a near callback of the
/// program's lets pass for the first time, or whose bodies a callback has moved meanwhile) is computed in the third,
/// within a slice of its own. A near callback that withholds a pair costs its work once.
///
/// Frames. The budget is one frame's. By itself a frame begins with each dispatch of the world's pair cache, so each
/// substep is one; ghosts and character controllers, whose caches are dispatched after the world's, share it. (The
/// world's cache is the first that comes by.) Or the program says when: see beginFrame.
///
/// A callback (of contacts: added, processed, started, ended, destroyed; or the near callback, which then returns) may
/// remove bodies and constraints, as far as Bullet can stand it: not with m_deterministicOverlappingPairs, and while
/// one body of a pair is being removed not the other one of the same pair. Delete them after the step. Destroy the
/// world first, then the dispatcher. Two dispatchers on two threads are fine.
template <class Base>
class BasicDispatcher : public Base {
    static_assert(std::is_base_of_v<btCollisionDispatcher, Base>);

  public:
    template <class... Arguments>
    requires(std::is_constructible_v<Base, Arguments...> &&
             (!std::is_same_v<std::remove_cvref_t<Arguments>, BasicDispatcher> &&
              ...)) explicit BasicDispatcher(Arguments&&... arguments)
        : Base(std::forward<Arguments>(arguments)...) {
        m_status = registerAlgorithms(this);
    }
    ~BasicDispatcher() override { unregisterAlgorithms(this); }
    BasicDispatcher(const BasicDispatcher&) = delete;
    BasicDispatcher& operator=(const BasicDispatcher&) = delete;

    void dispatchAllCollisionPairs(btOverlappingPairCache* cache, const btDispatcherInfo& info,
                                   btDispatcher* dispatcher) override {
        const detail::DispatchPhases phases(*this, cache, info);
        Base::dispatchAllCollisionPairs(cache, info, dispatcher);
    }

    /// A frame begins now, and from here on only so: for a program that calls stepSimulation with several substeps per
    /// picture. Each of the next `dispatches` substeps may take an equal share of what is left; further ones get what
    /// remains, and their mandatory slices.
    void beginFrame(int dispatches = 1) noexcept { detail::beginFrame(*this, dispatches); }

    /// How the registration in the constructor went: ok or outOfMemory.
    [[nodiscard]] Status status() const noexcept { return m_status; }

  private:
    Status m_status = Status::ok;
};

using Dispatcher = BasicDispatcher<btCollisionDispatcher>;

}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
