#include <grapeshot/plugin/shadow.hpp>

#include <BulletCollision/BroadphaseCollision/btOverlappingPairCache.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btCollisionWorld.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include <grapeshot/plugin/detail/context.hpp>
#include <grapeshot/plugin/detail/leaf_shapes.hpp>
#include <grapeshot/plugin/detail/silent_callbacks.hpp>
#include <grapeshot/plugin/detail/twin_dispatcher.hpp>
#include <grapeshot/plugin/registration.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {

namespace {

using detail::Contexts;
using detail::TableCopy;
using detail::TwinAlgorithm;
using detail::TwinDispatcher;

struct Touch {
    btVector3 position{0, 0, 0};  // on the second body, world frame
    btVector3 normal{0, 0, 0};    // towards the first body
    btScalar distance = 0;
};

/// Points of the pair's manifolds that touch, deepest first.
std::vector<Touch> touches(btCollisionAlgorithm& algorithm, const btCollisionObject* first) {
    btManifoldArray manifolds;
    algorithm.getAllContactManifolds(manifolds);
    std::vector<Touch> all;
    for (int m = 0; m < manifolds.size(); ++m) {
        const btPersistentManifold& manifold = *manifolds[m];
        const bool sameOrder = manifold.getBody0() == first;
        for (int i = 0; i < manifold.getNumContacts(); ++i) {
            const btManifoldPoint& point = manifold.getContactPoint(i);
            if (point.getDistance() <= 0) {
                all.push_back({sameOrder ? point.getPositionWorldOnB() : point.getPositionWorldOnA(),
                               sameOrder ? point.m_normalWorldOnB : -point.m_normalWorldOnB, point.getDistance()});
            }
        }
    }
    std::stable_sort(all.begin(), all.end(), [](const Touch& x, const Touch& y) { return x.distance < y.distance; });
    return all;
}

double angleBetween(const btVector3& x, const btVector3& y) {
    return std::atan2(static_cast<double>(x.cross(y).length()), static_cast<double>(x.dot(y)));
}

/// Two sides of one pair of bodies, from step to step.
struct Entry {
    // What it was made for; another body may have taken an address or an id.
    std::array<const btCollisionObject*, 2> objects{};
    std::array<const btCollisionShape*, 2> shapes{};
    std::array<int, 2> types{};
    bool relevant = false;
    std::unique_ptr<TwinAlgorithm> theirs, ours;
    std::uint64_t seen = 0;

    [[nodiscard]] bool isFor(const std::array<btCollisionObject*, 2>& bodies) const {
        for (std::size_t i = 0; i < 2; ++i) {
            const btCollisionShape* shape = bodies[i]->getCollisionShape();
            if (objects[i] != bodies[i] || shapes[i] != shape || types[i] != shape->getShapeType()) {
                return false;
            }
        }
        return true;
    }
};

}  // namespace

struct Shadow::State {
    Settings settings;
    const btCollisionDispatcher* original = nullptr;
    TableCopy tables;  // of the original, ours included: whether somebody has registered since
    std::uint64_t settingsVersion = 0;
    std::optional<TwinDispatcher> theirs, ours;
    std::map<std::pair<int, int>, Entry> entries;  // by broadphase id; after the dispatchers: gone before them
    std::uint64_t step = 0;
    std::vector<ShadowPair> pairs;
    ShadowTotals totals;
    double depthDifferences = 0, normalAngles = 0;

    ~State() { drop(); }

    void drop() {
        const detail::SilentCallbacks silence;
        entries.clear();
        if (ours) {
            static_cast<void>(unregisterAlgorithms(&ours->dispatcher()));
        }
        if (theirs) {
            static_cast<void>(unregisterAlgorithms(&theirs->dispatcher()));
        }
        ours.reset();
        theirs.reset();
        original = nullptr;
    }

    /// Twins with the original's tables, made anew when these have changed.
    Status follow(btCollisionDispatcher& dispatcher) {
        const std::shared_ptr<detail::Context> context = Contexts::instance().find(&dispatcher);
        const bool registered = context && context->isIn(dispatcher);
        const std::uint64_t version = registered ? context->settingsVersion : 0;
        TableCopy now = detail::tablesOf(dispatcher, false);
        if (original == &dispatcher && now == tables && version == settingsVersion) {
            return Status::ok;
        }
        drop();
        const int slot = detail::slotBytes(dispatcher);
        const TableCopy plain = detail::tablesOf(dispatcher, true);
        for (std::optional<TwinDispatcher>* twin : {&theirs, &ours}) {
            twin->emplace(slot);
            (*twin)->setTables(plain);
            (*twin)->dispatcher().setDispatcherFlags(dispatcher.getDispatcherFlags() &
                                                     ~btCollisionDispatcher::CD_DISABLE_CONTACTPOOL_DYNAMIC_ALLOCATION);
        }
        if (registered) {
            if (const Status status = registerAlgorithms(&theirs->dispatcher(), context->settings);
                status != Status::ok) {
                return status;
            }
            Contexts::instance().find(&theirs->dispatcher())->beside = true;
        }
        if (const Status status = registerAlgorithms(&ours->dispatcher(), settings); status != Status::ok) {
            return status;
        }
        const std::shared_ptr<detail::Context> own = Contexts::instance().find(&ours->dispatcher());
        own->framed = true;  // `observe` says when a step begins
        own->beside = true;
        original = &dispatcher;
        tables = std::move(now);
        settingsVersion = version;
        return Status::ok;
    }

    Entry& entryOf(const btBroadphasePair& pair, const std::array<btCollisionObject*, 2>& bodies) {
        Entry& entry = entries[{pair.m_pProxy0->getUid(), pair.m_pProxy1->getUid()}];
        if (!entry.isFor(bodies)) {
            entry = {};
            for (std::size_t i = 0; i < 2; ++i) {
                entry.objects[i] = bodies[i];
                entry.shapes[i] = bodies[i]->getCollisionShape();
                entry.types[i] = entry.shapes[i]->getShapeType();
            }
            entry.relevant = isRelevant(*entry.shapes[0], *entry.shapes[1]);
        }
        entry.seen = step;
        return entry;
    }

    /// Do the two sides take it to different algorithms?
    [[nodiscard]] bool isRelevant(const btCollisionShape& first, const btCollisionShape& second) {
        std::vector<detail::PlacedShape> a, b;
        detail::appendLeaves(first, btTransform::getIdentity(), a);
        detail::appendLeaves(second, btTransform::getIdentity(), b);
        for (const detail::PlacedShape& leafA : a) {
            for (const detail::PlacedShape& leafB : b) {
                const int typeA = leafA.shape->getShapeType();
                const int typeB = leafB.shape->getShapeType();
                if (creatorIn(theirs->dispatcher(), detail::Table::contacts, typeA, typeB) !=
                    creatorIn(ours->dispatcher(), detail::Table::contacts, typeA, typeB)) {
                    return true;
                }
            }
        }
        return false;
    }

    static std::vector<Touch> run(TwinDispatcher& twin, std::unique_ptr<TwinAlgorithm>& algorithm,
                                  const btCollisionObjectWrapper& first, const btCollisionObjectWrapper& second,
                                  const btDispatcherInfo& info, ShadowSide& side) {
        if (algorithm == nullptr) {
            algorithm = twin.make(first, second);
        }
        if (algorithm == nullptr) {
            return {};
        }
        const auto start = std::chrono::steady_clock::now();
        btManifoldResult result(&first, &second);
        algorithm->get()->processCollision(&first, &second, info, &result);
        side.time = std::chrono::steady_clock::now() - start;
        std::vector<Touch> found = touches(*algorithm->get(), first.getCollisionObject());
        side.contacts = static_cast<int>(found.size());
        side.depth = found.empty() ? 0.0 : static_cast<double>(-found.front().distance);
        return found;
    }

    void compare(Entry& entry, const std::array<btCollisionObject*, 2>& bodies, const btDispatcherInfo& info,
                 const detail::Context& context) {
        const btCollisionObjectWrapper first(nullptr, bodies[0]->getCollisionShape(), bodies[0],
                                             bodies[0]->getWorldTransform(), -1, -1);
        const btCollisionObjectWrapper second(nullptr, bodies[1]->getCollisionShape(), bodies[1],
                                              bodies[1]->getWorldTransform(), -1, -1);
        ShadowPair pair;
        pair.first = bodies[0];
        pair.second = bodies[1];
        const std::vector<Touch> their = run(*theirs, entry.theirs, first, second, info, pair.theirs);
        const std::size_t known = context.statistics.pairs.size();
        const std::vector<Touch> mine = run(*ours, entry.ours, first, second, info, pair.ours);
        for (std::size_t i = known; i < context.statistics.pairs.size(); ++i) {
            const PairStatistics& part = context.statistics.pairs[i];
            pair.work += part.work;
            pair.degraded = pair.degraded || part.stop == StopReason::budget;
            pair.refused = pair.refused || part.stop == StopReason::invalidInput;
        }
        if (!their.empty() && !mine.empty()) {
            pair.depthDifference = pair.ours.depth - pair.theirs.depth;
            const btVector3& where = their.front().position;
            const auto nearest = std::min_element(mine.begin(), mine.end(), [&](const Touch& x, const Touch& y) {
                return x.position.distance2(where) < y.position.distance2(where);
            });
            pair.normalAngle = angleBetween(their.front().normal, nearest->normal);
        }
        add(pair);
        pairs.push_back(pair);
    }

    void add(const ShadowPair& pair) {
        const bool theirsTouch = pair.theirs.contacts > 0;
        const bool oursTouch = pair.ours.contacts > 0;
        ++totals.pairs;
        ++(theirsTouch ? (oursTouch ? totals.bothTouch : totals.onlyTheirs)
                       : (oursTouch ? totals.onlyOurs : totals.neither));
        totals.theirContacts += static_cast<std::uint64_t>(pair.theirs.contacts);
        totals.ourContacts += static_cast<std::uint64_t>(pair.ours.contacts);
        totals.theirTime += pair.theirs.time;
        totals.ourTime += pair.ours.time;
        totals.work += pair.work;
        totals.degraded += pair.degraded ? 1 : 0;
        totals.refused += pair.refused ? 1 : 0;
        if (theirsTouch && oursTouch) {
            const double difference = std::abs(pair.depthDifference);
            totals.largestDepthDifference = std::max(totals.largestDepthDifference, difference);
            totals.largestNormalAngle = std::max(totals.largestNormalAngle, pair.normalAngle);
            depthDifferences += difference;
            normalAngles += pair.normalAngle;
            totals.meanDepthDifference = depthDifferences / static_cast<double>(totals.bothTouch);
            totals.meanNormalAngle = normalAngles / static_cast<double>(totals.bothTouch);
        }
    }

    void observe(btCollisionWorld& world, btCollisionDispatcher& dispatcher) {
        const detail::SilentCallbacks silence;
        const std::shared_ptr<detail::Context> context = Contexts::instance().find(&ours->dispatcher());
        btDispatcherInfo info = world.getDispatchInfo();
        info.m_debugDraw = nullptr;
        ++step;
        pairs.clear();
        context->beginStep();
        ++context->dispatches;  // so that shapes are looked at anew
        const std::uint64_t fallbacks = context->statistics.fallbacks;
        const btBroadphasePairArray& all = world.getPairCache()->getOverlappingPairArray();
        for (int i = 0; i < all.size(); ++i) {
            const btBroadphasePair& pair = all[i];
            if (pair.m_algorithm == nullptr) {
                continue;
            }
            const std::array<btCollisionObject*, 2> bodies{
                static_cast<btCollisionObject*>(pair.m_pProxy0->m_clientObject),
                static_cast<btCollisionObject*>(pair.m_pProxy1->m_clientObject)};
            Entry& entry = entryOf(pair, bodies);
            if (entry.relevant && dispatcher.needsCollision(bodies[0], bodies[1])) {
                compare(entry, bodies, info, *context);
            }
        }
        std::erase_if(entries, [this](const auto& item) { return item.second.seen != step; });
        ++totals.steps;
        totals.fallbacks += context->statistics.fallbacks - fallbacks;
    }
};

Shadow::Shadow(const Settings& settings) : m_state(std::make_unique<State>()) {
    m_state->settings = settings;
}

Shadow::~Shadow() = default;

Status Shadow::observe(btCollisionWorld* world) noexcept {
    if (world == nullptr) {
        return Status::nullPointer;
    }
    try {
        auto* dispatcher = dynamic_cast<btCollisionDispatcher*>(world->getDispatcher());
        if (dispatcher == nullptr) {
            return Status::badArgument;
        }
        if (const Status status = m_state->follow(*dispatcher); status != Status::ok) {
            m_state->drop();
            return status;
        }
        m_state->observe(*world, *dispatcher);
        return Status::ok;
    } catch (...) {
        m_state->drop();
        return Status::outOfMemory;
    }
}

const std::vector<ShadowPair>& Shadow::pairs() const noexcept {
    return m_state->pairs;
}

const ShadowTotals& Shadow::totals() const noexcept {
    return m_state->totals;
}

void Shadow::reset() noexcept {
    m_state->pairs.clear();
    m_state->totals = {};
    m_state->depthDifferences = m_state->normalAngles = 0;
}

std::string toText(const ShadowTotals& totals) {
    const auto number = [](double value) {
        char text[32];
        std::snprintf(text, sizeof text, "%.3g", value);
        return std::string(text);
    };
    const auto micros = [&](std::chrono::nanoseconds time) {
        const double steps = static_cast<double>(std::max<std::uint64_t>(1, totals.steps));
        return number(static_cast<double>(time.count()) / 1000 / steps);
    };
    const double degrees = 180 / 3.14159265358979323846;
    std::string text = std::to_string(totals.steps) + " steps, " + std::to_string(totals.pairs) +
                       " pairs: " + std::to_string(totals.bothTouch) + " touch on both sides, " +
                       std::to_string(totals.onlyTheirs) + " only theirs, " + std::to_string(totals.onlyOurs) +
                       " only ours, " + std::to_string(totals.neither) + " neither\n";
    text += "contacts: " + std::to_string(totals.theirContacts) + " theirs, " + std::to_string(totals.ourContacts) +
            " ours\n";
    text += "depth differs by " + number(totals.meanDepthDifference) + " m (largest " +
            number(totals.largestDepthDifference) + "), normals by " + number(degrees * totals.meanNormalAngle) +
            " degrees (largest " + number(degrees * totals.largestNormalAngle) + ")\n";
    text += "time per step: " + micros(totals.theirTime) + " us theirs, " + micros(totals.ourTime) + " us ours (" +
            std::to_string(totals.work) + " work units in all)\n";
    text += std::to_string(totals.degraded) + " cut short, " + std::to_string(totals.refused) + " refused, " +
            std::to_string(totals.fallbacks) + " handed to GImpact\n";
    return text;
}

}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
