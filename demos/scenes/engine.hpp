// Who finds the contacts of a scene's meshes, and the one place where that is switched.
#pragma once

#include <btBulletDynamicsCommon.h>

#include <string_view>

#include <grapeshot/plugin.hpp>

namespace grapeshot::scenes {

enum class Engine {
    none,       ///< plain Bullet: concave against concave is silently empty
    gimpact,    ///< btGImpactCollisionAlgorithm
    grapeshot,  ///< this library, by its one line
    hull,       ///< moving meshes replaced by their convex hulls
};

[[nodiscard]] std::string_view name(Engine engine) noexcept;   ///< as in options and reports
[[nodiscard]] std::string_view title(Engine engine) noexcept;  ///< as people write it

/// A dispatcher that measures itself: dispatchAllCollisionPairs is the narrowphase. With other engines than ours it is
/// plain Bullet's.
class TimedDispatcher : public Dispatcher {
  public:
    using Dispatcher::Dispatcher;
    void dispatchAllCollisionPairs(btOverlappingPairCache* pairs, const btDispatcherInfo& info,
                                   btDispatcher* dispatcher) override;

    /// Of the last step: wall clock and this thread's processor time (other threads' is not counted), s.
    [[nodiscard]] double seconds() const { return m_seconds; }
    [[nodiscard]] double cpuSeconds() const { return m_cpuSeconds; }
    void resetClock() { m_seconds = m_cpuSeconds = 0; }

  private:
    double m_seconds = 0;
    double m_cpuSeconds = 0;
};

/// Throws Error (badSetting) if the library refuses the settings.
void install(Engine engine, btCollisionDispatcher& dispatcher, const Settings& settings);
/// What GImpact does when a shape is made: builds the tree now, and not in the first step that needs it.
void prepare(Engine engine, const btCollisionShape& shape, Method method = Method::automatic);
/// To be called when the world is gone and before the dispatcher goes.
void uninstall(Engine engine, btCollisionDispatcher& dispatcher);

}  // namespace grapeshot::scenes
