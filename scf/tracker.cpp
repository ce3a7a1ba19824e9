#include <grapeshot/scf/tracker.hpp>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include <grapeshot/scf/detail/moved_since.hpp>
#include <grapeshot/scf/detail/placing.hpp>
#include <grapeshot/scf/detail/track_motion.hpp>
#include <grapeshot/scf/detail/track_step.hpp>
#include <grapeshot/scf/detail/tracker_file.hpp>

namespace grapeshot {
namespace {

bool isUsable(const TrackSettings& s) {
    return std::isfinite(s.maxDistance) && s.maxDistance >= 0 && std::isfinite(s.spacing) && s.spacing > 0 &&
           std::isfinite(s.followDistance) && s.followDistance >= 0 && std::isfinite(s.exclusion) && s.exclusion >= 0 &&
           std::isfinite(s.lookAhead) && s.lookAhead >= 0 && s.frontCells >= 16 && s.frontCells <= 4096 &&
           s.auditShare >= 0 && s.auditShare <= 1 && std::isfinite(s.tolerance) && s.tolerance > 0 &&
           s.mode >= TrackMode::exact && s.mode <= TrackMode::budget;
}

}  // namespace

struct Tracker::State {
    State(const BallTree& first, const BallTree& second, bool self) : a(&first), b(&second), oneBody(self) {}
    State(const State& other) : a(other.a), b(other.b), oneBody(other.oneBody), memory(other.memory) {}
    State& operator=(const State&) = delete;
    [[nodiscard]] bool isSelf() const { return oneBody; }

    void step(const SurfaceState& stateA, const SurfaceState* stateB, const TrackSettings& settings,
              const Budget& budget, TrackResult& out);
    void step(const SurfaceMotion& motionA, const SurfaceMotion* motionB, const TrackSettings& settings,
              const Budget& budget, TrackResult& out);
    void stepWithin(SurfaceMotion body, const TrackSettings& settings, const Budget& budget, TrackResult& out);
    void cut(const TrackSettings& settings);
    /// Empty, but for its memory.
    static void clear(TrackResult& out);
    void refuse(Fault fault, TrackResult& out) const;

    const BallTree* a;
    const BallTree* b;  ///< two bodies may share a tree
    bool oneBody;
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
        scratch->aroundA.begin(scratch->spacingA.cells.size());
        if (!isSelf()) {
            scratch->spacingB = detail::cellsOfRadius(*b, settings.spacing);
            scratch->aroundB.begin(scratch->spacingB.cells.size());
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

void Tracker::State::clear(TrackResult& out) {
    std::vector<TrackedContact> contacts = std::move(out.contacts);
    std::vector<TrackedContact> ahead = std::move(out.ahead);
    contacts.clear();
    ahead.clear();
    out = {};
    out.contacts = std::move(contacts);
    out.ahead = std::move(ahead);
}

void Tracker::State::refuse(Fault fault, TrackResult& out) const {
    out.contacts.clear();
    out.ahead.clear();
    out.certain = false;
    out.stop = StopReason::invalidInput;
    out.fault = fault;
    out.miss = {};
    out.carried = 0;
    out.tracked = static_cast<std::uint32_t>(memory.tracked.size());
    out.dives = 0;
}

void Tracker::State::step(const SurfaceState& stateA, const SurfaceState* stateB, const TrackSettings& settings,
                          const Budget& budget, TrackResult& out) {
    clear(out);
    const auto refuse = [&](Fault fault) { this->refuse(fault, out); };
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
        scratch = std::make_unique<detail::TrackerScratch>(*a, *b, oneBody);
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
    const bool asksForMotion = (settings.keepFront || settings.lookAhead > 0) && detail::isTold(stateA) &&
                               (isSelf() || detail::isTold(*stateB));
    detail::Deformation deformedA;
    detail::Deformation deformedB;
    std::optional<float> nearer;
    if (asksForMotion) {
        const detail::FrontMemory& before = memory.front;
        deformedA = detail::deformationSince(before.a, stateA, a->surface, a->extent);
        if (stateB != nullptr) {
            deformedB = detail::deformationSince(before.b, *stateB, b->surface, b->extent);
        }
        if (std::isnan(deformedA.most) || std::isnan(deformedB.most)) {
            return refuse(Fault::notFinite);
        }
        nearer = stateB == nullptr
                     ? detail::nearerThanBefore(before.a, deformedA)
                     : detail::nearerThanBefore(before.a, stateA, deformedA, before.b, *stateB, deformedB);
    }
    const detail::PairSpace space{&scratch->a, isSelf() ? &scratch->a : &*scratch->b, settings.maxDistance,
                                  isSelf() ? settings.exclusion : -1};
    detail::TrackStep run(space, settings, budget, nearer, memory, *scratch, out);
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
    if (!asksForMotion) {
        memory.front = {};
        return;
    }
    detail::remember(stateA, deformedA, memory.front.a);
    if (stateB != nullptr) {
        detail::remember(*stateB, deformedB, memory.front.b);
    }
}

void Tracker::State::step(const SurfaceMotion& motionA, const SurfaceMotion* motionB, const TrackSettings& settings,
                          const Budget& budget, TrackResult& out) {
    clear(out);
    if (!isUsable(settings)) {
        return refuse(Fault::badSetting, out);
    }
    if (const auto fault = detail::faultIn(motionA, a->surface)) {
        return refuse(*fault, out);
    }
    if (const auto fault = motionB != nullptr ? detail::faultIn(*motionB, b->surface) : std::nullopt) {
        return refuse(*fault, out);
    }
    out.stretchA = detail::stretchToUse(motionA, a->surface);
    out.stretchB = motionB != nullptr ? detail::stretchToUse(*motionB, b->surface) : out.stretchA;
    if (std::isnan(out.stretchA) || std::isnan(out.stretchB)) {
        return refuse(Fault::notFinite, out);
    }
    if (!scratch) {
        scratch = std::make_unique<detail::TrackerScratch>(*a, *b, oneBody);
    }
    cut(settings);
    if (!scratch->movingA) {
        scratch->movingA.emplace(*a);
        if (!isSelf()) {
            scratch->movingB.emplace(*b);
        }
    }
    detail::MovingTree& movingA = *scratch->movingA;
    detail::MovingTree& movingB = isSelf() ? movingA : *scratch->movingB;
    detail::Meter meter(budget);
    const detail::ImpactSpace space{&movingA, &movingB, settings.maxDistance, settings.tolerance,
                                    isSelf() ? settings.exclusion : -1};
    const float turn = std::max(motionA.frame.turn.norm(), motionB != nullptr ? motionB->frame.turn.norm() : 0);
    const int parts = std::max(1, static_cast<int>(std::ceil(turn / detail::largestTurn)));
    detail::TrackMotion run(space, settings, meter, memory, *scratch, out);
    for (int part = 0; part < parts; ++part) {
        movingA.begin(motionA, out.stretchA, {part, parts});
        if (motionB != nullptr) {
            movingB.begin(*motionB, out.stretchB, {part, parts});
        }
        const bool mayGoOn = run.run({part, parts});
        out.work = run.work();
        if (!movingA.isFinite() || !movingB.isFinite()) {
            return refuse(Fault::notFinite, out);
        }
        if (!mayGoOn) {
            break;
        }
    }
    run.finish();
    memory.front = {};
}

/// The frame moves nothing against anything: the body is searched in its own.
void Tracker::State::stepWithin(SurfaceMotion body, const TrackSettings& settings, const Budget& budget,
                                TrackResult& out) {
    if (const auto fault = detail::faultIn(body.frame)) {
        clear(out);
        return refuse(*fault, out);
    }
    const RigidMotion frame = std::exchange(body.frame, {});
    step(body, nullptr, settings, budget, out);
    for (TrackedContact& contact : out.contacts) {
        const Pose pose = poseAt(frame, static_cast<double>(contact.time));
        contact.onA = apply(pose, contact.onA);
        contact.onB = apply(pose, contact.onB);
        contact.normal = pose.rotation * contact.normal;
    }
}

Tracker::Tracker(const BallTree& a, const BallTree& b) : m_state(std::make_unique<State>(a, b, false)) {}
Tracker::Tracker(const BallTree& body) : m_state(std::make_unique<State>(body, body, true)) {}
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
    assert(!m_state->isSelf() && "made of one body: it tracks the body with itself");
    m_state->step(a, &b, settings, budget, out);
}

TrackResult Tracker::step(const SurfaceState& a, const SurfaceState& b, const TrackSettings& settings, Budget budget) {
    TrackResult out;
    step(a, b, settings, budget, out);
    return out;
}

void Tracker::step(const SurfaceState& body, const TrackSettings& settings, Budget budget, TrackResult& out) {
    assert(m_state->isSelf() && "made of two bodies");
    m_state->step(body, nullptr, settings, budget, out);
}

TrackResult Tracker::step(const SurfaceState& body, const TrackSettings& settings, Budget budget) {
    TrackResult out;
    step(body, settings, budget, out);
    return out;
}

void Tracker::sweep(const SurfaceMotion& a, const SurfaceMotion& b, const TrackSettings& settings, Budget budget,
                    TrackResult& out) {
    assert(!m_state->isSelf() && "made of one tree: it tracks the body with itself");
    m_state->step(a, &b, settings, budget, out);
}

TrackResult Tracker::sweep(const SurfaceMotion& a, const SurfaceMotion& b, const TrackSettings& settings,
                           Budget budget) {
    TrackResult out;
    sweep(a, b, settings, budget, out);
    return out;
}

void Tracker::sweep(const SurfaceMotion& body, const TrackSettings& settings, Budget budget, TrackResult& out) {
    assert(m_state->isSelf() && "made of two trees");
    m_state->stepWithin(body, settings, budget, out);
}

TrackResult Tracker::sweep(const SurfaceMotion& body, const TrackSettings& settings, Budget budget) {
    TrackResult out;
    sweep(body, settings, budget, out);
    return out;
}

void Tracker::clear() {
    m_state->memory.tracked.clear();
    m_state->memory.front = {};
}

std::uint64_t Tracker::steps() const {
    return m_state->memory.step;
}

std::vector<std::byte> Tracker::save() const {
    return detail::savedMemory(m_state->memory, {*m_state->a, *m_state->b, m_state->oneBody});
}

void Tracker::load(std::span<const std::byte> bytes) {
    m_state->memory = detail::loadedMemory(bytes, {*m_state->a, *m_state->b, m_state->oneBody});
}

}  // namespace grapeshot
