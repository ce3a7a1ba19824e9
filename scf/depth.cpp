#include <grapeshot/scf/depth.hpp>

#include <algorithm>
#include <cassert>
#include <cmath>

#include <grapeshot/scf/detail/depth_step.hpp>
#include <grapeshot/scf/detail/placing.hpp>

namespace grapeshot {
namespace {

bool areUsable(const DepthSettings& settings, std::span<const TrackedContact> contacts,
               std::span<const ContactSides> sides, const DepthMemory& memory, const BallTree& a, const BallTree& b) {
    if (!(settings.spacing >= 0) || !std::isfinite(settings.spacing) ||
        (!sides.empty() && sides.size() != contacts.size())) {
        return false;
    }
    const auto isSide = [](int side) { return side == 1 || side == -1; };
    return std::ranges::all_of(sides, [&](const ContactSides& s) { return isSide(s.ofA) && isSide(s.ofB); }) &&
           std::ranges::all_of(contacts,
                               [&](const TrackedContact& contact) {
                                   return contact.pair.triangleA < a.surface.triangles.size() &&
                                          contact.pair.triangleB < b.surface.triangles.size();
                               }) &&
           std::ranges::all_of(memory.summits, [&](const DepthMemory::Summit& summit) {
               const Surface& own = summit.isOfA ? a.surface : b.surface;
               const Surface& other = summit.isOfA ? b.surface : a.surface;
               return summit.vertex < own.rest.size() && summit.triangle < other.triangles.size() &&
                      std::ranges::all_of(summit.anchors,
                                          [&](std::uint32_t anchor) { return anchor < a.surface.triangles.size(); }) &&
                      isSide(summit.side);
           });
}

}  // namespace

struct DepthQuery::State {
    State(const BallTree& treeA, const BallTree& treeB) : bodyA(treeA), a(treeA) {
        if (&treeA != &treeB) {
            bodyB.emplace(treeB);
            b.emplace(treeB);
        }
    }
    DepthResult measure(const SurfaceState& stateA, const SurfaceState* stateB,
                        std::span<const TrackedContact> contacts, std::span<const ContactSides> sides,
                        const DepthSettings& settings, DepthMemory& memory, const Budget& budget);

    detail::DepthBody bodyA;
    std::optional<detail::DepthBody> bodyB;  ///< not of a body with itself
    detail::PosedTree a;
    std::optional<detail::PosedTree> b;
    detail::DepthScratch scratch;
};

DepthResult DepthQuery::State::measure(const SurfaceState& stateA, const SurfaceState* stateB,
                                       std::span<const TrackedContact> contacts, std::span<const ContactSides> sides,
                                       const DepthSettings& settings, DepthMemory& memory, const Budget& budget) {
    const auto refused = [](Fault fault) {
        DepthResult none;
        none.fault = fault;
        return none;
    };
    detail::PosedTree& posedB = b ? *b : a;
    const bool isSheetOfItself = !b && sides.empty() && !contacts.empty();
    if (isSheetOfItself || !areUsable(settings, contacts, sides, memory, a.tree(), posedB.tree())) {
        return refused(Fault::badSetting);
    }
    if (const auto fault = detail::faultIn(stateA, a.tree().surface)) {
        return refused(*fault);
    }
    if (const auto fault = stateB != nullptr ? detail::faultIn(*stateB, posedB.tree().surface) : std::nullopt) {
        return refused(*fault);
    }
    if (const auto placed = detail::place(stateA, a); placed.fault) {
        return refused(*placed.fault);
    }
    if (stateB != nullptr) {
        if (const auto placed = detail::place(*stateB, posedB); placed.fault) {
            return refused(*placed.fault);
        }
    }
    detail::DepthStep step(bodyA, a, b ? *bodyB : bodyA, posedB, settings, scratch);
    DepthMemory next;
    DepthResult result;
    detail::Meter meter(budget);
    step.run(contacts, sides, memory, meter, next, result);
    if (result.fault || !a.isFinite() || !posedB.isFinite() ||
        std::ranges::any_of(result.regions, [](const DepthRegion& region) {
            return !region.onA.allFinite() || !region.onB.allFinite() || !std::isfinite(region.depth);
        })) {
        return refused(Fault::notFinite);
    }
    result.stop = result.complete ? StopReason::certain : StopReason::budget;
    memory = std::move(next);
    return result;
}

DepthQuery::DepthQuery(const BallTree& a, const BallTree& b) : m_state(std::make_unique<State>(a, b)) {}
DepthQuery::DepthQuery(const BallTree& body) : m_state(std::make_unique<State>(body, body)) {}
DepthQuery::DepthQuery(DepthQuery&&) noexcept = default;
DepthQuery& DepthQuery::operator=(DepthQuery&&) noexcept = default;
DepthQuery::~DepthQuery() = default;

DepthResult DepthQuery::measure(const SurfaceState& a, const SurfaceState& b, std::span<const TrackedContact> contacts,
                                std::span<const ContactSides> sides, const DepthSettings& settings, DepthMemory& memory,
                                Budget budget) {
    assert(m_state->b && "made of one tree: it is for the body with itself");
    return m_state->measure(a, &b, contacts, sides, settings, memory, budget);
}

DepthResult DepthQuery::measure(const SurfaceState& body, std::span<const TrackedContact> contacts,
                                std::span<const ContactSides> sides, const DepthSettings& settings, DepthMemory& memory,
                                Budget budget) {
    assert(!m_state->b && "made of two trees");
    return m_state->measure(body, nullptr, contacts, sides, settings, memory, budget);
}

}  // namespace grapeshot
