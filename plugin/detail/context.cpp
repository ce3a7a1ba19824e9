#include <grapeshot/plugin/detail/context.hpp>

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/Gimpact/btGImpactCollisionAlgorithm.h>

#include <algorithm>
#include <atomic>

#include <grapeshot/plugin/detail/shape_kind.hpp>
#include <grapeshot/plugin/detail/soft_algorithm.hpp>
#include <grapeshot/plugin/detail/swept_compound.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

namespace {

constexpr std::array meshTypes{TRIANGLE_MESH_SHAPE_PROXYTYPE, SCALED_TRIANGLE_MESH_SHAPE_PROXYTYPE,
                               MULTIMATERIAL_TRIANGLE_MESH_PROXYTYPE, TERRAIN_SHAPE_PROXYTYPE, GIMPACT_SHAPE_PROXYTYPE};
// Concave kinds that we do not know. Compounds are Bullet's own recursion.
constexpr std::array unknownTypes{FAST_CONCAVE_MESH_PROXYTYPE, STATIC_PLANE_PROXYTYPE, CUSTOM_CONCAVE_SHAPE_TYPE};

std::uint64_t nextSerial() {
    static std::atomic<std::uint64_t> last = 0;
    return ++last;
}

}  // namespace

Context::Context(const Settings& chosen) : settings(chosen), serial(nextSerial()) {
    creators[0] = std::make_unique<MeshCollisionAlgorithm::CreateFunc>(*this, false);
    creators[1] = std::make_unique<MeshCollisionAlgorithm::CreateFunc>(*this, true);
    gimpact = std::make_unique<btGImpactCollisionAlgorithm::CreateFunc>();
    soft = std::make_unique<SoftAlgorithm::CreateFunc>(*this);
    sweptCompounds = std::make_unique<SweptCompoundAlgorithm::CreateFunc>(*this);
    // All pairs of types, so that counting cannot fail.
    statistics.taken.reserve(std::size_t{MAX_BROADPHASE_COLLISION_TYPES} * (MAX_BROADPHASE_COLLISION_TYPES + 1) / 2);
}

Context::~Context() = default;

void Context::take(btCollisionDispatcher& dispatcher, Table table, int first, int second,
                   btCollisionAlgorithmCreateFunc* placed) {
    btCollisionAlgorithmCreateFunc* ours = placed != nullptr ? placed : creators[static_cast<std::size_t>(table)].get();
    btCollisionAlgorithmCreateFunc* present = creatorIn(dispatcher, table, first, second);
    if (present == ours) {
        return;
    }
    const auto known = std::find_if(cells.begin(), cells.end(), [&](const Cell& cell) {
        return cell.table == table && cell.first == first && cell.second == second;
    });
    Cell& cell = known != cells.end() ? *known : cells.emplace_back();
    const bool wasEmpty = present == nullptr || present == emptyCreatorIn(dispatcher, table);
    cell = {table, first, second, present, ours, wasEmpty, nullptr};
    setCreator(dispatcher, table, first, second, ours);
}

namespace {

/// Is the place one that these settings take?
bool isWanted(const Cell& cell, const Settings& settings) {
    if (cell.first == SOFTBODY_SHAPE_PROXYTYPE || cell.second == SOFTBODY_SHAPE_PROXYTYPE) {
        return settings.softPairs;
    }
    const bool gimpact = cell.first == GIMPACT_SHAPE_PROXYTYPE || cell.second == GIMPACT_SHAPE_PROXYTYPE;
    if (gimpact) {
        const int other = cell.first == GIMPACT_SHAPE_PROXYTYPE ? cell.second : cell.first;
        return settings.convexPairs || !(isSolidType(other) || other == COMPOUND_SHAPE_PROXYTYPE);
    }
    return settings.bvhConvexPairs ||
           !(btBroadphaseProxy::isConvex(cell.first) || btBroadphaseProxy::isConvex(cell.second));
}

}  // namespace

void Context::install(btCollisionDispatcher& dispatcher) {
    cells.reserve(768);  // so that nothing below can fail half way
    giveBackUnwanted(dispatcher);
    for (const Table table : {Table::contacts, Table::closest}) {
        for (const int first : meshTypes) {
            for (const int second : meshTypes) {
                take(dispatcher, table, first, second);
            }
        }
        takeSolids(dispatcher, table);
        if (settings.convexPairs) {
            takeCompounds(dispatcher, table);
        }
        for (const int other : unknownTypes) {
            takeIfEmpty(dispatcher, table, GIMPACT_SHAPE_PROXYTYPE, other);
            takeIfEmpty(dispatcher, table, other, GIMPACT_SHAPE_PROXYTYPE);
        }
    }
    if (settings.speculative) {
        takeSweptCompounds(dispatcher);
    }
    if (settings.softPairs) {
        takeSoft(dispatcher);
    }
}

/// Contacts ahead are for the simulation alone.
void Context::takeSweptCompounds(btCollisionDispatcher& dispatcher) {
    constexpr int compound = COMPOUND_SHAPE_PROXYTYPE;
    takeSweptCompound(dispatcher, compound, compound);
    const auto takeBoth = [&](int other) {
        takeSweptCompound(dispatcher, compound, other);
        takeSweptCompound(dispatcher, other, compound);
    };
    std::ranges::for_each(meshTypes, takeBoth);
    for (int solid = 0; solid <= STATIC_PLANE_PROXYTYPE; ++solid) {
        if (isSolidType(solid)) {
            takeBoth(solid);
        }
    }
}

/// In front of whoever has the place, takeCompounds included.
void Context::takeSweptCompound(btCollisionDispatcher& dispatcher, int first, int second) {
    btCollisionAlgorithmCreateFunc* present = creatorIn(dispatcher, Table::contacts, first, second);
    if (!isWanted({Table::contacts, first, second}, settings) || present == nullptr ||
        present == sweptCompounds.get() || present == emptyCreatorIn(dispatcher, Table::contacts)) {
        return;
    }
    const auto known = std::find_if(cells.begin(), cells.end(), [&](const Cell& cell) {
        return cell.table == Table::contacts && cell.first == first && cell.second == second;
    });
    if (known != cells.end() && known->placed == present) {
        known->asked = present;
        known->placed = sweptCompounds.get();
        setCreator(dispatcher, Table::contacts, first, second, sweptCompounds.get());
    } else {
        take(dispatcher, Table::contacts, first, second, sweptCompounds.get());
    }
}

/// Only where the configuration knows soft bodies. Queries have no algorithm for them, not even Bullet's.
void Context::takeSoft(btCollisionDispatcher& dispatcher) {
    constexpr int type = SOFTBODY_SHAPE_PROXYTYPE;
    const auto* known = creatorIn(dispatcher, Table::contacts, type, type);
    if (known == nullptr || known == emptyCreatorIn(dispatcher, Table::contacts)) {
        return;
    }
    take(dispatcher, Table::contacts, type, type, soft.get());
    for (const int mesh : meshTypes) {
        take(dispatcher, Table::contacts, type, mesh, soft.get());
        take(dispatcher, Table::contacts, mesh, type, soft.get());
    }
}

/// Places from an earlier call, with other settings.
void Context::giveBackUnwanted(btCollisionDispatcher& dispatcher) {
    std::erase_if(cells, [&](const Cell& cell) {
        if (isWanted(cell, settings)) {
            return false;
        }
        giveBack(dispatcher, cell);
        return true;
    });
}

void Context::takeSolids(btCollisionDispatcher& dispatcher, Table table) {
    for (const int mesh : meshTypes) {
        for (int solid = 0; solid <= STATIC_PLANE_PROXYTYPE; ++solid) {
            if (isSolidType(solid) && isWanted({table, mesh, solid}, settings)) {
                take(dispatcher, table, mesh, solid);
                take(dispatcher, table, solid, mesh);
            }
        }
    }
}

/// GImpact's algorithm takes the places of compounds too, and never asks the dispatcher for their children. So Bullet's
/// own recursion comes back.
void Context::takeCompounds(btCollisionDispatcher& dispatcher, Table table) {
    const auto replace = [&](int first, int second, btCollisionAlgorithmCreateFunc* recursion) {
        const auto* present = creatorIn(dispatcher, table, first, second);
        if (dynamic_cast<const btGImpactCollisionAlgorithm::CreateFunc*>(present) != nullptr) {
            take(dispatcher, table, first, second, recursion);
        }
    };
    constexpr int compound = COMPOUND_SHAPE_PROXYTYPE;
    // No algorithm of GImpact's or ours is for spheres in compounds.
    replace(compound, GIMPACT_SHAPE_PROXYTYPE, creatorIn(dispatcher, table, compound, SPHERE_SHAPE_PROXYTYPE));
    replace(GIMPACT_SHAPE_PROXYTYPE, compound, creatorIn(dispatcher, table, SPHERE_SHAPE_PROXYTYPE, compound));
}

/// A place that somebody else has taken since is theirs.
void Context::takeIfEmpty(btCollisionDispatcher& dispatcher, Table table, int first, int second) {
    btCollisionAlgorithmCreateFunc* present = creatorIn(dispatcher, table, first, second);
    if (present == emptyCreatorIn(dispatcher, table)) {
        take(dispatcher, table, first, second);
    } else if (present != creators[static_cast<std::size_t>(table)].get()) {
        lostCells = std::erase_if(cells,
                                  [&](const Cell& cell) {
                                      return cell.table == table && cell.first == first && cell.second == second;
                                  }) > 0 ||
                    lostCells;
    }
}

void Context::giveBack(btCollisionDispatcher& dispatcher, const Cell& cell) const {
    if (creatorIn(dispatcher, cell.table, cell.first, cell.second) == cell.placed) {
        setCreator(dispatcher, cell.table, cell.first, cell.second, cell.previous);
    }
}

bool Context::uninstall(btCollisionDispatcher& dispatcher) {
    const bool allHeld = heldCells(dispatcher) == cells.size() && !lostCells;
    for (const Cell& cell : cells) {
        giveBack(dispatcher, cell);
    }
    return allHeld;
}

std::size_t Context::heldCells(const btCollisionDispatcher& dispatcher) const {
    return static_cast<std::size_t>(std::count_if(cells.begin(), cells.end(), [&](const Cell& cell) {
        return creatorIn(dispatcher, cell.table, cell.first, cell.second) == cell.placed;
    }));
}

bool Context::isIn(const btCollisionDispatcher& dispatcher) const {
    return std::any_of(cells.begin(), cells.end(), [&](const Cell& cell) {
        return cell.placed == creators[static_cast<std::size_t>(cell.table)].get() &&
               creatorIn(dispatcher, cell.table, cell.first, cell.second) == cell.placed;
    });
}

btCollisionAlgorithm* Context::createForeign(btCollisionAlgorithmConstructionInfo& info,
                                             const btCollisionObjectWrapper* body0,
                                             const btCollisionObjectWrapper* body1, Table table) {
    const btCollisionShape& first = *body0->getCollisionShape();
    const btCollisionShape& second = *body1->getCollisionShape();
    const auto cell = std::find_if(cells.begin(), cells.end(), [&](const Cell& candidate) {
        return candidate.table == table && candidate.first == first.getShapeType() &&
               candidate.second == second.getShapeType();
    });
    const bool none = cell == cells.end() || cell->wasEmpty;
    if (none && (isGImpact(first) || isGImpact(second))) {
        ++statistics.fallbacks;
        return gimpact->CreateCollisionAlgorithm(info, body0, body1);
    }
    return cell != cells.end() && cell->previous != nullptr
               ? cell->previous->CreateCollisionAlgorithm(info, body0, body1)
               : nullptr;
}

btCollisionAlgorithm* Context::createPrevious(btCollisionAlgorithmConstructionInfo& info,
                                              const btCollisionObjectWrapper& body0,
                                              const btCollisionObjectWrapper& body1) {
    const auto cell = std::find_if(cells.begin(), cells.end(), [&](const Cell& candidate) {
        return candidate.table == Table::contacts && candidate.first == body0.getCollisionShape()->getShapeType() &&
               candidate.second == body1.getCollisionShape()->getShapeType();
    });
    if (cell == cells.end()) {
        return nullptr;
    }
    btCollisionAlgorithmCreateFunc* creator = cell->asked != nullptr ? cell->asked : cell->previous;
    return creator != nullptr ? creator->CreateCollisionAlgorithm(info, &body0, &body1) : nullptr;
}

void Context::beginStep() {
    StepStatistics& s = statistics;
    ++s.step;
    s.work = s.candidates = s.droppedRegions = 0;
    s.contacts = s.speculative = s.manifolds = s.traversals = s.refreshed = s.degraded = s.refused = 0;
    s.tracked = s.sampled = s.leftToAdb = 0;
    s.deepest = 0;
    s.longestWait = 0;
    s.budget = unlimited;
    s.mandatory = 0;
    s.building = 0;
    s.dispatches = 0;
    s.pairs.clear();
}

std::uint64_t Context::enterStep(std::uint64_t lastStep) {
    if (statistics.step == 0 || (!framed && lastStep == statistics.step)) {
        beginStep();
    }
    return statistics.step;
}

void Context::reportFrame() {
    statistics.work += frame.building() - statistics.building;
    statistics.building = frame.building();
    statistics.budget = frame.budget().work;
    statistics.mandatory = frame.mandatory();
    statistics.dispatches = frame.dispatches();
}

void Context::record(const PairStatistics& pair) {
    StepStatistics& s = statistics;
    s.work += pair.work;
    s.candidates += pair.candidates;
    s.droppedRegions += pair.droppedRegions;
    s.contacts += pair.contacts;
    s.speculative += pair.speculative;
    s.manifolds += pair.manifolds;
    s.traversals += pair.traversed ? 1 : 0;
    s.refreshed += pair.refreshed ? 1 : 0;
    s.tracked += pair.method == Method::scf ? 1 : 0;
    s.sampled += pair.sampled ? 1 : 0;
    s.leftToAdb += pair.leftToAdb ? 1 : 0;
    s.degraded += pair.stop == StopReason::budget ? 1 : 0;
    s.longestWait = std::max(s.longestWait, pair.age);
    s.deepest = std::max(s.deepest, pair.deepest);
    s.pairs.push_back(pair);
}

void Context::countAlgorithm(int shapeType0, int shapeType1) {
    ++statistics.algorithms;
    const auto [a, b] = std::minmax(shapeType0, shapeType1);
    for (TakenPairs& kind : statistics.taken) {
        if (kind.shapeTypeA == a && kind.shapeTypeB == b) {
            ++kind.algorithms;
            return;
        }
    }
    statistics.taken.push_back({a, b, 1});
}

void Context::refuse(PairStatistics pair, const std::string& reason) {
    pair.stop = StopReason::invalidInput;
    record(pair);
    ++statistics.refused;
    ++statistics.refusals;
    statistics.lastRefusal = reason;
}

Contexts& Contexts::instance() {
    // Never destroyed: a program's last dispatcher may be destroyed later than static objects.
    static Contexts& contexts = *new Contexts;
    return contexts;
}

std::shared_ptr<Context> Contexts::find(const btCollisionDispatcher* dispatcher) {
    const std::lock_guard lock(m_mutex);
    const auto item = std::find_if(m_items.begin(), m_items.end(),
                                   [dispatcher](const Item& candidate) { return candidate.dispatcher == dispatcher; });
    return item != m_items.end() ? item->context : nullptr;
}

void Contexts::insert(const btCollisionDispatcher* dispatcher, std::shared_ptr<Context> context) {
    remove(dispatcher, false);
    const std::lock_guard lock(m_mutex);
    m_items.push_back({dispatcher, std::move(context)});
}

void Contexts::remove(const btCollisionDispatcher* dispatcher, bool keep) {
    const std::lock_guard lock(m_mutex);
    const auto item = std::find_if(m_items.begin(), m_items.end(),
                                   [dispatcher](const Item& candidate) { return candidate.dispatcher == dispatcher; });
    if (item == m_items.end()) {
        return;
    }
    if (keep) {
        m_kept.push_back(item->context);
    }
    m_items.erase(item);
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
