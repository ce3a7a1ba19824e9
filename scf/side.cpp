#include <grapeshot/scf/side.hpp>

#include <cassert>
#include <cmath>

#include <grapeshot/scf/detail/placing.hpp>
#include <grapeshot/scf/detail/side_memory.hpp>
#include <grapeshot/scf/detail/side_step.hpp>

namespace grapeshot {

std::vector<ContactSides> SideResult::sides() const {
    std::vector<ContactSides> all;
    all.reserve(contacts.size());
    for (const SidedContact& contact : contacts) {
        all.push_back(contact.sides);
    }
    return all;
}

struct SideKeeper::State {
    State(const BallTree& first, const BallTree& second)
        : a(&first), b(&second), bodies(std::make_shared<const detail::SideBodies>(first, second)) {}
    State(const State& other)
        : a(other.a), b(other.b), bodies(other.bodies), cells(other.cells), memory(other.memory) {}
    State& operator=(const State&) = delete;

    SideResult step(const SurfaceMotion& motionA, const SurfaceMotion& motionB,
                    std::span<const TrackedContact> contacts, const SideSettings& settings);

    const BallTree* a;
    const BallTree* b;  ///< the same for a body with itself
    std::shared_ptr<const detail::SideBodies> bodies;
    std::shared_ptr<const detail::SideCells> cells;
    detail::SideMemory memory;
    std::unique_ptr<detail::SideScratch> scratch;
};

SideResult SideKeeper::State::step(const SurfaceMotion& motionA, const SurfaceMotion& motionB,
                                   std::span<const TrackedContact> contacts, const SideSettings& settings) {
    SideResult result;
    const auto refused = [&](Fault fault) {
        SideResult none;
        none.fault = fault;
        none.kept = memory.kept.size();
        return none;
    };
    if (!(settings.spacing > 0) || !std::isfinite(settings.spacing)) {
        return refused(Fault::badSetting);
    }
    for (const TrackedContact& contact : contacts) {
        if (contact.pair.triangleA >= a->surface.triangles.size() ||
            contact.pair.triangleB >= b->surface.triangles.size() || contact.featureA > 6 || contact.featureB > 6) {
            return refused(Fault::badSetting);
        }
        if (!contact.onA.allFinite() || !contact.onB.allFinite() || !contact.normal.allFinite()) {
            return refused(Fault::notFinite);
        }
    }
    if (const auto fault = detail::faultIn(motionA, a->surface)) {
        return refused(*fault);
    }
    if (const auto fault = detail::faultIn(motionB, b->surface)) {
        return refused(*fault);
    }
    if (!cells || cells->spacing != settings.spacing) {
        cells = std::make_shared<const detail::SideCells>(*a, *b, settings.spacing);
    }
    if (!scratch) {
        scratch = std::make_unique<detail::SideScratch>(*a, *b);
    }
    detail::SideMemory next = memory;
    if (next.spacing != settings.spacing) {
        next.kept.clear();
        next.spacing = settings.spacing;
    }
    detail::SideStep run(*a, *b, *bodies, *cells, next, *scratch);
    if (!run.begin(motionA, motionB, contacts)) {
        return refused(Fault::notFinite);
    }
    run.decide(contacts, result.contacts);
    run.finish(settings.keepSteps);
    result.kept = next.kept.size();
    memory = std::move(next);
    return result;
}

SideKeeper::SideKeeper(const BallTree& a, const BallTree& b) : m_state(std::make_unique<State>(a, b)) {}
SideKeeper::SideKeeper(const BallTree& body) : m_state(std::make_unique<State>(body, body)) {}
SideKeeper::SideKeeper(const SideKeeper& other)
    : m_state(other.m_state ? std::make_unique<State>(*other.m_state) : nullptr) {}
SideKeeper& SideKeeper::operator=(const SideKeeper& other) {
    if (this != &other) {
        m_state = other.m_state ? std::make_unique<State>(*other.m_state) : nullptr;
    }
    return *this;
}
SideKeeper::SideKeeper(SideKeeper&&) noexcept = default;
SideKeeper& SideKeeper::operator=(SideKeeper&&) noexcept = default;
SideKeeper::~SideKeeper() = default;

SideResult SideKeeper::step(const SurfaceMotion& a, const SurfaceMotion& b, std::span<const TrackedContact> contacts,
                            const SideSettings& settings) {
    assert(m_state->a != m_state->b && "made of one tree: it is for the body with itself");
    return m_state->step(a, b, contacts, settings);
}

SideResult SideKeeper::step(const SurfaceMotion& body, std::span<const TrackedContact> contacts,
                            const SideSettings& settings) {
    assert(m_state->a == m_state->b && "made of two trees");
    return m_state->step(body, body, contacts, settings);
}

void SideKeeper::clear() {
    m_state->memory.kept.clear();
}

std::vector<std::byte> SideKeeper::save() const {
    return detail::savedSides(m_state->memory, *m_state->a, *m_state->b);
}

void SideKeeper::load(std::span<const std::byte> bytes) {
    m_state->memory = detail::loadedSides(bytes, *m_state->a, *m_state->b);
}

}  // namespace grapeshot
