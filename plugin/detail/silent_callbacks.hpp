// Bullet's global callbacks for contacts, switched off for a while.
#pragma once

#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include <utility>

#include <grapeshot/plugin/precision.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

/// While it lives, contacts come and go without the program hearing of them. They are globals of the process: not while
/// another thread steps a world.
class SilentCallbacks {
  public:
    SilentCallbacks()
        : m_added(std::exchange(gContactAddedCallback, nullptr)),
          m_destroyed(std::exchange(gContactDestroyedCallback, nullptr)),
          m_processed(std::exchange(gContactProcessedCallback, nullptr)),
          m_started(std::exchange(gContactStartedCallback, nullptr)),
          m_ended(std::exchange(gContactEndedCallback, nullptr)) {}
    ~SilentCallbacks() {
        gContactAddedCallback = m_added;
        gContactDestroyedCallback = m_destroyed;
        gContactProcessedCallback = m_processed;
        gContactStartedCallback = m_started;
        gContactEndedCallback = m_ended;
    }
    SilentCallbacks(const SilentCallbacks&) = delete;
    SilentCallbacks& operator=(const SilentCallbacks&) = delete;

  private:
    ContactAddedCallback m_added;
    ContactDestroyedCallback m_destroyed;
    ContactProcessedCallback m_processed;
    ContactStartedCallback m_started;
    ContactEndedCallback m_ended;
};

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
