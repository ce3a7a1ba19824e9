#include "engine.hpp"

#include <BulletCollision/Gimpact/btGImpactCollisionAlgorithm.h>

#include <string>

#include <grapeshot/core/error.hpp>
#include <report/machine.hpp>

namespace grapeshot::scenes {

std::string_view name(Engine engine) noexcept {
    switch (engine) {
        case Engine::none:
            return "none";
        case Engine::gimpact:
            return "gimpact";
        case Engine::grapeshot:
            return "grapeshot";
        case Engine::hull:
            return "hull";
    }
    return "unknown";
}

std::string_view title(Engine engine) noexcept {
    switch (engine) {
        case Engine::none:
            return "Bullet";
        case Engine::gimpact:
            return "GImpact";
        case Engine::grapeshot:
            return "Grapeshot";
        case Engine::hull:
            return "convex hull";
    }
    return "unknown";
}

void TimedDispatcher::dispatchAllCollisionPairs(btOverlappingPairCache* pairs, const btDispatcherInfo& info,
                                                btDispatcher* dispatcher) {
    const double wall = report::wallUs();
    const double cpu = report::threadCpuUs();
    Dispatcher::dispatchAllCollisionPairs(pairs, info, dispatcher);
    m_seconds += 1e-6 * (report::wallUs() - wall);
    m_cpuSeconds += 1e-6 * (report::threadCpuUs() - cpu);
}

void install(Engine engine, btCollisionDispatcher& dispatcher, const Settings& settings) {
    if (engine != Engine::grapeshot) {
        static_cast<void>(unregisterAlgorithms(&dispatcher));  // a TimedDispatcher comes with our algorithms
    }
    if (engine == Engine::gimpact) {
        btGImpactCollisionAlgorithm::registerAlgorithm(&dispatcher);
    }
    if (engine == Engine::grapeshot && registerAlgorithms(&dispatcher, settings) != Status::ok) {
        throw Error(Fault::badSetting, "the library refuses these settings", "registerAlgorithms");
    }
}

void prepare(Engine engine, const btCollisionShape& shape, Method method) {
    if (engine == Engine::grapeshot) {
        if (const Status status = prebuild(&shape, method); status != Status::ok) {
            throw Error(Fault::noSurface, std::string(name(status)), "prebuild");
        }
    }
}

void uninstall(Engine engine, btCollisionDispatcher& dispatcher) {
    if (engine == Engine::grapeshot) {
        static_cast<void>(unregisterAlgorithms(&dispatcher));  // it can only fail if install did
    }
}

}  // namespace grapeshot::scenes
