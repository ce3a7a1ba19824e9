#include <grapeshot/scf/closest_features.hpp>

#include <cassert>
#include <cmath>

#include <grapeshot/scf/detail/closest_search.hpp>
#include <grapeshot/scf/detail/placing.hpp>

namespace grapeshot {
namespace {

bool isUsable(const ClosestSettings& s) {
    return s.maxDistance >= 0 && (std::isfinite(s.maxDistance) || s.most == 1) && s.most >= 1 &&
           std::isfinite(s.spacing) && s.spacing >= 0 && std::isfinite(s.exclusion) && s.exclusion >= 0;
}

}  // namespace

struct ClosestQuery::State {
    State(const BallTree& treeA, const BallTree& treeB) : a(treeA) {
        if (&treeA != &treeB) {
            b.emplace(treeB);
        }
    }
    ClosestResult find(const SurfaceState& stateA, const SurfaceState* stateB, const ClosestSettings& settings,
                       std::span<const TrianglePair> known, const Budget& budget);

    detail::PosedTree a;
    std::optional<detail::PosedTree> b;  ///< not of a body with itself
    detail::ClosestSearch search;
};

ClosestResult ClosestQuery::State::find(const SurfaceState& stateA, const SurfaceState* stateB,
                                        const ClosestSettings& settings, std::span<const TrianglePair> known,
                                        const Budget& budget) {
    ClosestResult result;
    const auto refused = [&](Fault fault) {
        ClosestResult none;
        none.fault = fault;
        none.work = result.work;
        return none;
    };
    if (!isUsable(settings)) {
        return refused(Fault::badSetting);
    }
    if (const auto fault = detail::faultIn(stateA, a.tree().surface)) {
        return refused(*fault);
    }
    if (const auto fault = stateB != nullptr ? detail::faultIn(*stateB, b->tree().surface) : std::nullopt) {
        return refused(*fault);
    }
    if (const auto placed = detail::place(stateA, a, detail::Centers::vertices); placed.fault) {
        return refused(*placed.fault);
    }
    if (stateB != nullptr) {
        if (const auto placed = detail::place(*stateB, *b, detail::Centers::vertices); placed.fault) {
            return refused(*placed.fault);
        }
    }
    const detail::PairSpace space{&a, b ? &*b : &a, 0, b ? -1 : settings.exclusion};
    detail::Meter meter(budget);
    search.begin(space, settings);
    for (const TrianglePair& pair : known) {
        if (meter.left(search.work()) == 0) {
            break;
        }
        search.look(pair);
    }
    result.certain = search.run(meter, result.pairs);
    result.atLeast = search.atLeast();
    result.work = search.work();
    if (!a.isFinite() || !space.b->isFinite() || !search.isFinite()) {
        return refused(Fault::notFinite);
    }
    result.stop = result.certain ? StopReason::certain : StopReason::budget;
    return result;
}

ClosestQuery::ClosestQuery(const BallTree& a, const BallTree& b) : m_state(std::make_unique<State>(a, b)) {}
ClosestQuery::ClosestQuery(const BallTree& body) : m_state(std::make_unique<State>(body, body)) {}
ClosestQuery::ClosestQuery(ClosestQuery&&) noexcept = default;
ClosestQuery& ClosestQuery::operator=(ClosestQuery&&) noexcept = default;
ClosestQuery::~ClosestQuery() = default;

ClosestResult ClosestQuery::find(const SurfaceState& a, const SurfaceState& b, const ClosestSettings& settings,
                                 std::span<const TrianglePair> known, Budget budget) {
    assert(m_state->b && "made of one tree: it is for the body with itself");
    return m_state->find(a, &b, settings, known, budget);
}

ClosestResult ClosestQuery::find(const SurfaceState& body, const ClosestSettings& settings,
                                 std::span<const TrianglePair> known, Budget budget) {
    assert(!m_state->b && "made of two trees");
    return m_state->find(body, nullptr, settings, known, budget);
}

}  // namespace grapeshot
