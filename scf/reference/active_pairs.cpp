#include <grapeshot/scf/reference/active_pairs.hpp>

#include <algorithm>
#include <tuple>

#include <grapeshot/core/error.hpp>
#include <grapeshot/core/random.hpp>
#include <grapeshot/scf/reference/detail/collisions.hpp>
#include <grapeshot/scf/reference/detail/fan_distance.hpp>
#include <grapeshot/scf/reference/detail/local_search.hpp>
#include <grapeshot/scf/reference/detail/pair_creation.hpp>
#include <grapeshot/scf/reference/detail/pair_removal.hpp>

namespace grapeshot::scf::reference {

namespace {

using namespace detail;

/// A state of other surfaces would be read out of bounds.
void requireOwn(const Surface& a, const Surface& b, const State& state) {
    const auto count = [](const Surface& surface, std::size_t level) {
        return surface.levels[std::min(level, surface.levels.size() - 1)].centre.size();
    };
    for (const ActivePair& pair : state.pairs) {
        const bool exists = pair.level < std::max(a.levels.size(), b.levels.size());
        if (!exists || pair.a >= count(a, pair.level) || pair.b >= count(b, pair.level)) {
            throw Error(Fault::indexOutOfRange, "an active pair of other surfaces", "state");
        }
    }
    const bool remembers = !state.beforeA.empty() || !state.beforeB.empty();
    if (remembers && (state.beforeA.size() != a.vertexCount || state.beforeB.size() != b.vertexCount)) {
        throw Error(Fault::indexOutOfRange, "vertices of other surfaces", "state");
    }
}

void addNew(const PlacedSurface& a, const PlacedSurface& b, const Settings& settings, State& state, Work& work) {
    const Before before{state.beforeA, state.beforeB};
    const Created created = createPairs(a, b, before, settings, {settings.seed, settings.pair, state.steps});
    for (const FeaturePair& pair : created.pairs) {
        state.pairs.push_back({.a = pair.a, .b = pair.b, .level = pair.level});
    }
    work.created = created.pairs.size();
    work.regions = created.regions;
    work.boxTests = created.boxTests;
}

void goDownhill(const PlacedSurface& a, const PlacedSurface& b, const Settings& settings, State& state, Work& work) {
    const LocalSearch search(a, b, settings);
    SearchWork spent;
    for (ActivePair& active : state.pairs) {
        FeaturePair pair{active.a, active.b, active.level};
        search.descend(pair, spent);
        active.a = pair.a;
        active.b = pair.b;
        active.level = pair.level;
        active.triangleA = active.triangleB = 0;
        if (pair.level == 0) {
            const FanDistance fan = fanDistance(a, pair.a, b, pair.b, work.trianglePairs);
            active.distance = fan.distance;
            active.triangleA = fan.triangleA;
            active.triangleB = fan.triangleB;
        } else {
            active.distance = search.gap(pair);
        }
    }
    work.featureDistances = spent.distances;
    work.moves = spent.moves;
}

}  // namespace

StepResult step(const Surface& a, const Surface& b, std::span<const Eigen::Vector3f> verticesA,
                std::span<const Eigen::Vector3f> verticesB, const Settings& settings, State& state) {
    requireUsable(settings);
    const PlacedSurface placedA(a, verticesA, "body A");
    const PlacedSurface placedB(b, verticesB, "body B");
    requireOwn(a, b, state);
    StepResult result;
    addNew(placedA, placedB, settings, state, result.work);
    goDownhill(placedA, placedB, settings, state, result.work);
    result.work.redundant = removeRedundant(a, b, settings.redundancy, state.pairs);
    result.work.far = removeFar(std::max(placedA.size(), placedB.size()), settings, state.pairs);
    for (const ActivePair& pair : state.pairs) {
        result.closest = pair.level == 0 ? std::min(result.closest, pair.distance) : result.closest;
    }
    result.contacts = collisions(placedA, placedB, settings, state.pairs, result.work);
    for (ActivePair& pair : state.pairs) {
        ++pair.age;
    }
    std::ranges::sort(state.pairs, {}, [](const ActivePair& p) { return std::tuple(p.level, p.a, p.b, p.age); });
    ++state.steps;
    if (settings.velocityShare > 0) {
        state.beforeA.assign(verticesA.begin(), verticesA.end());
        state.beforeB.assign(verticesB.begin(), verticesB.end());
    } else {
        state.beforeA.clear();
        state.beforeB.clear();
    }
    return result;
}

}  // namespace grapeshot::scf::reference
