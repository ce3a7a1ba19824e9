// The part of the preloaded library that knows Bullet, once per precision.
#include <BulletCollision/BroadphaseCollision/btBroadphaseProxy.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>

#include <charconv>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <string>
#include <vector>

#include <grapeshot/plugin/plugin.hpp>
#include <grapeshot/plugin/preload/log_line.hpp>
#include <grapeshot/plugin/preload/take_over.hpp>

namespace {

using namespace grapeshot;

const char* nameOf(int shapeType) {
    switch (shapeType) {
        case TRIANGLE_MESH_SHAPE_PROXYTYPE:
            return "BVH mesh";
        case SCALED_TRIANGLE_MESH_SHAPE_PROXYTYPE:
            return "scaled BVH mesh";
        case GIMPACT_SHAPE_PROXYTYPE:
            return "GImpact mesh";
        case STATIC_PLANE_PROXYTYPE:
            return "plane";
        case MULTIMATERIAL_TRIANGLE_MESH_PROXYTYPE:
            return "multi-material mesh";
        case TERRAIN_SHAPE_PROXYTYPE:
            return "height field";
        default:
            return btBroadphaseProxy::isConvex(shapeType) ? "convex" : "other";
    }
}

/// The dispatchers that are ours, in the order in which they came.
class Taken {
  public:
    /// Never destroyed: see interposers.cpp.
    static Taken& instance() {
        static auto* const one = new Taken;
        return *one;
    }

    void add(btCollisionDispatcher* dispatcher) {
        const std::lock_guard lock(m_mutex);
        const Status status = registerAlgorithms(dispatcher, m_settings);
        if (status != Status::ok) {
            preload::logLine("a dispatcher could not be taken over");
            return;
        }
        for (const Item& item : m_items) {
            if (item.dispatcher == dispatcher) {
                return;  // GImpact was registered on it
            }
        }
        m_items.push_back({dispatcher, ++m_count});
        // Not before: what is made after this goes before it, and the statistics would be gone.
        static const bool reportsAtTheEnd = std::atexit([] { instance().reportAll(); }) == 0;
        static_cast<void>(reportsAtTheEnd);
    }

    void remove(btCollisionDispatcher* dispatcher) {
        const std::lock_guard lock(m_mutex);
        for (auto item = m_items.begin(); item != m_items.end(); ++item) {
            if (item->dispatcher == dispatcher) {
                report(*item);
                static_cast<void>(unregisterAlgorithms(dispatcher));
                m_items.erase(item);
                return;
            }
        }
    }

    void reportAll() {
        const std::lock_guard lock(m_mutex);
        for (const Item& item : m_items) {
            report(item);
        }
        m_items.clear();
    }

  private:
    struct Item {
        btCollisionDispatcher* dispatcher;
        int number;
    };

    Taken() {
        const char* exact = std::getenv(preload::exactVariable);
        if (exact != nullptr && std::strcmp(exact, "") != 0 && std::strcmp(exact, "0") != 0) {
            m_settings = Settings::exact();
        }
        if (const char* text = std::getenv(preload::budgetVariable)) {
            std::uint64_t work = 0;
            const char* end = text + std::strlen(text);
            const auto [place, error] = std::from_chars(text, end, work);
            if (error == std::errc() && place == end && work > 0) {
                m_settings.pairBudget.work = work;
            } else {
                preload::logLine(std::string(preload::budgetVariable) + " is '" + text +
                                 "', not a number from 1: left out");
            }
        }
    }

    static void report(const Item& item) {
        const StepStatistics& s = statistics(item.dispatcher);
        std::string text = "dispatcher " + std::to_string(item.number) + ", " +
                           (sizeof(btScalar) == 8 ? "double" : "single") + " precision, " + std::to_string(s.step) +
                           " steps: " + std::to_string(s.algorithms) + " pairs taken";
        for (const TakenPairs& taken : s.taken) {
            text += std::string("\ngrapeshot:   ") + nameOf(taken.shapeTypeA) + " against " + nameOf(taken.shapeTypeB) +
                    ": " + std::to_string(taken.algorithms);
        }
        text += "\ngrapeshot:   queries: " + std::to_string(s.queries) +
                ", left to GImpact: " + std::to_string(s.fallbacks) + ", refused: " + std::to_string(s.refusals);
        if (!s.lastRefusal.empty()) {
            text += " (" + s.lastRefusal + ")";
        }
        preload::logLine(text);
    }

    std::mutex m_mutex;
    Settings m_settings;
    std::vector<Item> m_items;
    int m_count = 0;
};

}  // namespace

#define GRAPESHOT_LOOKED_UP extern "C" __attribute__((visibility("default")))

GRAPESHOT_LOOKED_UP void grapeshotTakeOver(btCollisionDispatcher* dispatcher) noexcept {
    try {
        Taken::instance().add(dispatcher);
    } catch (...) {  // out of memory: the program goes on without us
    }
}

GRAPESHOT_LOOKED_UP void grapeshotLetGo(btCollisionDispatcher* dispatcher) noexcept {
    try {
        Taken::instance().remove(dispatcher);
    } catch (...) {
    }
}
