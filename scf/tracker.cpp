#include <grapeshot/scf/tracker.hpp>

#include <cassert>
#include <cmath>

#include <grapeshot/scf/detail/placing.hpp>
#include <grapeshot/scf/detail/track_step.hpp>
#include <grapeshot/scf/detail/tracker_file.hpp>

namespace grapeshot {
namespace {

bool isUsable(const TrackSettings& s) {
    return std::isfinite(s.maxDistance) && s.maxDistance >= 0 && std::isfinite(s.spacing) && s.spacing > 0 &&
           std::isfinite(s.followDistance) && s.followDistance >= 0 && std::isfinite(s.exclusion) && s.exclusion >= 0 &&
           s.frontCells >= 16 && s.frontCells <= 4096 && s.auditShare >= 0 && s.auditShare <= 1 &&
           s.mode >= TrackMode::exact && s.mode <= TrackMode::budget;
}

}  // namespace

struct Tracker::State {
    State(const BallTree& first, const BallTree& second) : a(&first), b(&second) {}
    State(const State& other) : a(other.a), b(other.b), memory(other.memory) {}
    State& operator=(const State&) = delete;
    [[nodiscard]] bool isSelf() const { return a == b; }

    void step(const SurfaceState& stateA, const SurfaceState* stateB, const TrackSettings& settings,
              const Budget& budget, TrackResult& out);
    void cut(const TrackSettings& settings);

    const BallTree* a;
    const BallTree* b;
    detail::TrackerMemory memory;
    std::unique_ptr<detail::TrackerScratch> scratch;
};

void Tracker::State::cut(const TrackSettings& settings) {
    if (settings.mode == TrackMode::exact) {
        return;
    }
    if (scratch->spacing != settings.spacing) {
        scratch->spacing = settings.spacing;
        scratch->spacingA = detail::cellsOfRadius(*a, settings.spacing);
        if (!isSelf()) {
            scratch->spacingB = detail::cellsOfRadius(*b, settings.spacing);
        }
    }
    if (settings.mode == TrackMode::budget && scratch->frontCells != settings.frontCells) {
        scratch->frontCells = settings.frontCells;
        scratch->frontA = detail::cellsOfCount(*a, settings.frontCells);
        if (!isSelf()) {
            scratch->frontB = detail::cellsOfCount(*b, settings.frontCells);
        }
    }
}

void Tracker::State::step(const SurfaceState& stateA, const SurfaceState* stateB, const TrackSettings& settings,
                          const Budget& budget, TrackResult& out) {
    std::vector<TrackedContact> contacts = std::move(out.contacts);  // for its memory
    contacts.clear();
    out = {};
    out.contacts = std::move(contacts);
    const auto refuse = [&](Fault fault) {
        out.contacts.clear();
        out.certain = false;
        out.stop = StopReason::invalidInput;
        out.fault = fault;
        out.miss = {};
        out.carried = 0;
        out.tracked = static_cast<std::uint32_t>(memory.tracked.size());
        out.dives = 0;
    };
    if (!isUsable(settings)) {
        return refuse(Fault::badSetting);
    }
    if (const auto fault = detail::faultIn(stateA, a->surface)) {
        return refuse(*fault);
    }
    if (stateB != nullptr) {
        if (const auto fault = detail::faultIn(*stateB, b->surface)) {
            return refuse(*fault);
        }
    }
    if (!scratch) {
        scratch = std::make_unique<detail::TrackerScratch>(*a, *b);
    }
    cut(settings);
    const detail::Placed posedA = detail::place(stateA, scratch->a);
    if (posedA.fault) {
        return refuse(*posedA.fault);
    }
    out.stretchA = posedA.stretch;
    out.stretchB = posedA.stretch;
    if (stateB != nullptr) {
        const detail::Placed posedB = detail::place(*stateB, *scratch->b);
        if (posedB.fault) {
            return refuse(*posedB.fault);
        }
        out.stretchB = posedB.stretch;
    }
    const detail::PairSpace space{&scratch->a, isSelf() ? &scratch->a : &*scratch->b, settings.maxDistance,
                                  isSelf() ? settings.exclusion : -1};
    detail::TrackStep run(space, settings, budget, memory, *scratch, out);
    switch (settings.mode) {
        case TrackMode::exact:
            run.exact();
            break;
        case TrackMode::resolution:
            run.resolution();
            break;
        case TrackMode::budget:
            run.sampled();
            break;
    }
    out.work = run.work();
    if (!run.isFinite()) {
        return refuse(Fault::notFinite);
    }
    run.finish();
}

Tracker::Tracker(const BallTree& a, const BallTree& b) : m_state(std::make_unique<State>(a, b)) {}
Tracker::Tracker(const BallTree& body) : m_state(std::make_unique<State>(body, body)) {}
Tracker::Tracker(const Tracker& other) : m_state(other.m_state ? std::make_unique<State>(*other.m_state) : nullptr) {}
Tracker& Tracker::operator=(const Tracker& other) {
    if (this != &other) {
        m_state = other.m_state ? std::make_unique<State>(*other.m_state) : nullptr;
    }
    return *this;
}
Tracker::Tracker(Tracker&&) noexcept = default;
Tracker& Tracker::operator=(Tracker&&) noexcept = default;
Tracker::~Tracker() = default;

void Tracker::step(const SurfaceState& a, const SurfaceState& b, const TrackSettings& settings, Budget budget,
                   TrackResult& out) {
    assert(!m_state->isSelf() && "made of one tree: it tracks the body with itself");
    m_state->step(a, &b, settings, budget, out);
}

TrackResult Tracker::step(const SurfaceState& a, const SurfaceState& b, const TrackSettings& settings, Budget budget) {
    TrackResult out;
    step(a, b, settings, budget, out);
    return out;
}

void Tracker::step(const SurfaceState& body, const TrackSettings& settings, Budget budget, TrackResult& out) {
    assert(m_state->isSelf() && "made of two trees");
    m_state->step(body, nullptr, settings, budget, out);
}

TrackResult Tracker::step(const SurfaceState& body, const TrackSettings& settings, Budget budget) {
    TrackResult out;
    step(body, settings, budget, out);
    return out;
}

void Tracker::clear() {
    m_state->memory.tracked.clear();
}

std::uint64_t Tracker::steps() const {
    return m_state->memory.step;
}

std::vector<std::byte> Tracker::save() const {
    return detail::savedMemory(m_state->memory, *m_state->a, *m_state->b);
}

void Tracker::load(std::span<const std::byte> bytes) {
    m_state->memory = detail::loadedMemory(bytes, *m_state->a, *m_state->b);
}

}  // namespace grapeshot
