#include <grapeshot/adb/query.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include <grapeshot/adb/detail/query_state.hpp>
#include <grapeshot/core/detail/leaf_triangles.hpp>

namespace grapeshot {

using detail::DescentEnd;
using detail::EstimateEnd;
using detail::SidePair;

namespace {

constexpr float never = std::numeric_limits<float>::infinity();
constexpr float unreachable = -1;  // rates are not negative

/// The rates at which the probability after `steps` is as high, and as low, as it must be.
std::pair<float, float> limitsAfter(const Calibration& calibration, std::uint64_t steps, float acceptAt,
                                    float rejectAt) {
    // By halves, in octaves: the probability does not fall.
    constexpr double range = 12;
    const auto above = [&](float probability, bool orEqual) {
        double low = -range;
        double high = range;
        for (int i = 0; i < 40; ++i) {
            const double middle = 0.5 * (low + high);
            const float p = probabilityAfter(calibration, static_cast<float>(std::exp2(middle)), steps);
            ((orEqual ? p >= probability : p > probability) ? high : low) = middle;
        }
        return std::pair(static_cast<float>(std::exp2(low)),
                         high < range ? static_cast<float>(std::exp2(high)) : never);
    };
    const float yes = acceptAt < 1 ? above(acceptAt, true).second : never;
    const float no = rejectAt > 0 ? above(rejectAt, false).first : 0;
    return {yes, no > std::exp2(-11.5F) ? no : unreachable};
}

detail::RateLimits limitsFor(const Calibration& calibration, float acceptAt, float rejectAt) {
    detail::RateLimits limits{};
    limits.yes[0] = never;
    limits.no[0] = unreachable;
    for (std::size_t steps = 1; steps < detail::limitSteps; ++steps) {
        if (steps > 1 && std::bit_width(steps - 1) == std::bit_width(steps - 2)) {
            limits.yes[steps] = limits.yes[steps - 1];  // of the same row of the table
            limits.no[steps] = limits.no[steps - 1];
        } else {
            std::tie(limits.yes[steps], limits.no[steps]) = limitsAfter(calibration, steps, acceptAt, rejectAt);
        }
    }
    return limits;
}

const detail::RateLimits noLimits = [] {
    detail::RateLimits limits{};
    std::fill(std::begin(limits.yes), std::end(limits.yes), never);
    std::fill(std::begin(limits.no), std::end(limits.no), unreachable);
    return limits;
}();

}  // namespace

Query::State::State(const State& other)
    : a(other.a),
      b(other.b),
      descent(other.descent),
      storageA(other.storageA),
      storageB(other.storageB),
      queue(other.queue),
      task(other.task),
      order(other.order),
      maxDistance(other.maxDistance),
      finished(other.finished),
      leafPending(other.leafPending),
      witness(other.witness),
      hasWitness(other.hasWitness),
      decision(other.decision),
      settings(other.settings),
      estimating(other.estimating),
      ignoreLimits(other.ignoreLimits),
      exactFrom(other.exactFrom),
      limits(other.limits),
      limitsOf(other.limitsOf),
      cut(other.cut),
      cutRates(other.cutRates),
      cutSidesA(other.cutSidesA),
      cutSidesB(other.cutSidesB) {
    lend();
}

void Query::State::lend() {
    descent.stackA = storageA.data();
    descent.stackB = storageB.data();
    descent.capacity = storageA.size();
    descent.owner = this;
    descent.grow = [](detail::Descent& borrower) {
        auto& state = *static_cast<State*>(borrower.owner);
        state.storageA.resize(2 * state.storageA.size());
        state.storageB.resize(2 * state.storageB.size());
        state.lend();
    };
    cut.sidesA = cutSidesA.data();
    cut.sidesB = cutSidesB.data();
    cut.rates = cutRates.data();
}

bool Query::State::start(Task newTask, const Pose& bInA, Order newOrder, float distance) {
    task = Task::none;
    finished = false;
    leafPending = false;
    estimating = false;
    descent.depth = 0;
    descent.work = 0;
    queue.clear();
    if (!(distance >= 0) || (newOrder != Order::depthFirst && newOrder != Order::bestFirst)) {
        return false;
    }
    const detail::PoseVerdict verdict = detail::prepare(bInA, a->radius, b->radius, distance, descent.prepared);
    if (verdict == detail::PoseVerdict::invalid) {
        return false;
    }
    task = newTask;
    order = newOrder;
    maxDistance = distance;
    finished = verdict == detail::PoseVerdict::apart || a->nodes.empty() || b->nodes.empty();
    descent.pose = bInA;
    descent.nodesA = a->nodes.data();
    descent.nodesB = b->nodes.data();
    descent.distributionsA = a->distributions.data();
    descent.distributionsB = b->distributions.data();
    descent.leavesA = a->leaves.data();
    descent.leavesB = b->leaves.data();
    return true;
}

void Query::State::put(SidePair pair, float margin) {
    if (finished) {
        return;
    }
    if (order == Order::bestFirst) {
        queue.push(pair, margin);
    } else {
        detail::push(descent, pair);
    }
}

DescentEnd Query::State::nextLeafPair(std::uint64_t units) {
    if (order == Order::depthFirst) {
        return detail::toLeafPair(descent, units);
    }
    while (!queue.empty()) {
        const SidePair pair = queue.top();
        if (detail::bothLeaves(pair)) {
            queue.pop();
            descent.found = pair;
            return DescentEnd::found;
        }
        if (units == 0) {
            return DescentEnd::budget;
        }
        --units;
        ++descent.work;
        queue.pop();
        detail::TouchingChild children[16];
        const int count = detail::touchingChildren(descent, pair, children);
        for (int i = 0; i < count; ++i) {
            queue.push(children[i].pair, children[i].margin);
        }
    }
    return DescentEnd::exhausted;
}

/// False if a setting is out of its range.
bool Query::State::useSettings(const DecideSettings& wanted) {
    if (!(wanted.acceptAt >= 0.5F && wanted.acceptAt <= 1) || !(wanted.rejectAt >= 0 && wanted.rejectAt <= 0.5F)) {
        return false;
    }
    if (wanted.estimateSteps > 0) {
        const Calibration* const calibration =
            wanted.calibration != nullptr ? wanted.calibration : &defaultCalibration();
        if (limitsOf != calibration || settings.acceptAt != wanted.acceptAt || settings.rejectAt != wanted.rejectAt) {
            limits = limitsFor(*calibration, wanted.acceptAt, wanted.rejectAt);
            limitsOf = calibration;
        }
    }
    settings = wanted;
    return true;
}

/// The witness of the last decision is taken up before the root. If it does not hit this time it is forgotten: bodies
/// that have parted would pay for it in each query.
void Query::State::recallWitness() {
    if (!hasWitness || finished) {
        return;
    }
    hasWitness = false;
    // The trees may have been rebuilt since.
    const auto stillLeaf = [](const Tree& tree, detail::Side side) {
        const std::size_t node = indexOf(side) >> 2U;
        if (node >= tree.nodes.size()) {
            return false;
        }
        const ChildRef child = tree.nodes[node].child[side & 3U];
        return child != noChild && isLeaf(child);
    };
    if (stillLeaf(*a, detail::sideA(witness)) && stillLeaf(*b, detail::sideB(witness))) {
        descent.found = witness;
        leafPending = true;
    }
}

/// DescentEnd::exhausted: nothing pending, or it does not overlap.
DescentEnd Query::State::testPending(std::uint64_t units) {
    if (!leafPending) {
        return DescentEnd::exhausted;
    }
    if (units == 0) {
        return DescentEnd::budget;
    }
    leafPending = false;
    ++descent.work;
    descent.lanes = detail::overlapsLeaves(detail::blockA(descent, descent.found).corner,
                                           detail::blockB(descent, descent.found).corner, descent.pose);
    return descent.lanes != 0 ? DescentEnd::found : DescentEnd::exhausted;
}

/// Exact, from the stack or the queue.
DescentEnd Query::State::nextOverlap(std::uint64_t units) {
    const std::uint64_t limit = units > unlimited - descent.work ? unlimited : descent.work + units;
    for (;;) {
        const DescentEnd pending = testPending(limit - descent.work);
        if (pending != DescentEnd::exhausted) {
            return pending;
        }
        if (order == Order::depthFirst) {
            return detail::toOverlap(descent, detail::Nearest::byMargin, limit - descent.work);
        }
        const DescentEnd end = nextLeafPair(limit - descent.work);
        if (end != DescentEnd::found) {
            return end;
        }
        leafPending = true;
    }
}

/// From the cut to the stack, the likeliest on top.
void Query::State::handOver() {
    estimating = false;
    exactFrom = descent.work;
    std::array<std::pair<float, std::uint32_t>, detail::cutCapacity> sorted;
    for (std::uint32_t i = 0; i < cut.count; ++i) {
        sorted[i] = {cut.rates[i], i};
    }
    std::sort(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(cut.count));
    for (std::size_t i = 0; i < cut.count; ++i) {
        const std::uint32_t from = sorted[i].second;
        detail::push(descent, detail::sidePair(cut.sidesA[from], cut.sidesB[from]));
    }
}

/// P(they collide) of an answer that is not certain.
float Query::State::collisionProbability() const {
    if (settings.estimateSteps == 0 || cut.steps == 0) {
        return 0.5F;
    }
    return estimating ? probabilityAfter(*limitsOf, cut.rate, cut.steps)
                      : probabilityAfterwards(*limitsOf, cut.rate, descent.work - exactFrom);
}

Decision Query::State::goOn(const Budget& budget) {
    bool sure = false;
    if (!finished) {
        DescentEnd end = DescentEnd::budget;
        detail::spend(
            budget, [this] { return descent.work; },
            [&](std::uint64_t units) {
                const std::uint64_t first = descent.work;
                end = testPending(units);
                if (end == DescentEnd::exhausted && estimating) {
                    const auto mostSteps = static_cast<std::uint32_t>(
                        std::min<std::uint64_t>(settings.estimateSteps, std::numeric_limits<std::uint32_t>::max()));
                    switch (detail::toEstimate(descent, cut, limitsOf->formula, ignoreLimits ? noLimits : limits,
                                               mostSteps, units - (descent.work - first))) {
                        case EstimateEnd::exhausted:
                            return true;
                        case EstimateEnd::found:
                            end = DescentEnd::found;
                            return true;
                        case EstimateEnd::limit:
                            end = DescentEnd::budget;
                            sure = true;
                            return true;
                        case EstimateEnd::budget:
                            end = DescentEnd::budget;
                            return false;
                        case EstimateEnd::handOver:
                            handOver();
                            break;
                    }
                }
                if (end == DescentEnd::exhausted) {
                    end = nextOverlap(units - (descent.work - first));
                }
                return end != DescentEnd::budget;
            });
        finished = end != DescentEnd::budget;
        ignoreLimits = sure;
        decision.work = descent.work;
        if (end == DescentEnd::found) {
            decision.collides = true;
            // Unused lanes repeat lane 0, so the lowest lane is a used one.
            const auto lane = static_cast<std::uint32_t>(std::countr_zero(descent.lanes));
            decision.witness = {detail::blockA(descent, descent.found).triangle[lane >> 2U],
                                detail::blockB(descent, descent.found).triangle[lane & 3U]};
            witness = descent.found;
            hasWitness = true;
        } else {
            decision.collides = false;
        }
    }
    decision.certain = finished;
    if (finished) {
        decision.probability = 1;
        decision.stop = StopReason::certain;
        return decision;
    }
    // Not quite one: that is for what is proven.
    const float probability = std::clamp(collisionProbability(), 1e-6F, 1 - 1e-6F);
    decision.collides = probability >= 0.5F;
    decision.probability = decision.collides ? probability : 1 - probability;
    decision.stop = sure ? StopReason::probability : StopReason::budget;
    return decision;
}

bool answerOf(const Decision& decision, Answer answer, const RandomKey& episode) noexcept {
    if (answer == Answer::mostLikely || decision.certain) {
        return decision.collides;
    }
    constexpr std::uint32_t draw = 0x616e7377;  // apart from all other draws of the pair
    const float probability = decision.collides ? decision.probability : 1 - decision.probability;
    return randomUnit(episode, draw) < probability;
}

Query::Query(const Tree& a, const Tree& b) : m_state(std::make_unique<State>(a, b)) {}
Query::Query(const Query& other) : m_state(std::make_unique<State>(*other.m_state)) {}
Query& Query::operator=(const Query& other) {
    if (this != &other) {
        m_state = std::make_unique<State>(*other.m_state);
    }
    return *this;
}
Query::Query(Query&&) noexcept = default;
Query& Query::operator=(Query&&) noexcept = default;
Query::~Query() = default;

Decision Query::decide(const Pose& bInA, const DecideSettings& settings, Budget budget) {
    State& state = *m_state;
    state.decision = Decision();
    if (!state.useSettings(settings) || !state.start(State::Task::decide, bInA, settings.order, 0)) {
        state.task = State::Task::none;
        return state.decision;
    }
    state.estimating = settings.estimateSteps > 0;
    state.ignoreLimits = false;
    state.cut.count = 0;
    state.cut.steps = 0;
    state.cut.rate = 0;
    if (!state.estimating) {
        state.put(detail::sidePair(0, 0), 0);
    } else {
        state.order = Order::depthFirst;
        state.cut.count = 1;
        state.cut.sidesA[0] = 0;
        state.cut.sidesB[0] = 0;
    }
    if (settings.tryWitness) {
        state.recallWitness();
    }
    return state.goOn(budget);
}

Decision Query::resume(Budget budget) {
    return m_state->task == State::Task::decide ? m_state->goOn(budget) : Decision();
}

}  // namespace grapeshot
