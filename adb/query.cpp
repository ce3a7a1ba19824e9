#include <grapeshot/adb/query.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>
#include <limits>

#include <grapeshot/adb/detail/query_state.hpp>
#include <grapeshot/adb/detail/whole_pair.hpp>
#include <grapeshot/core/detail/leaf_triangles.hpp>

namespace grapeshot {

using detail::DescentEnd;
using detail::EstimateEnd;
using detail::SidePair;

namespace {

/// D^2 at a rate of the row of whole surfaces. Infinity for a rate of 0.
float squaredDistanceAt(float wholeRate) {
    return 1 / std::sqrt(wholeRate);
}

}  // namespace

void Query::State::Limits::workOut() {
    rates = detail::noLimits;
    wholeYes = 0;
    wholeNo = std::numeric_limits<float>::infinity();
    if (acceptAt < 1) {
        wholeYes = squaredDistanceAt(leastRateAt(calibration->whole, acceptAt));
        for (std::size_t row = 0; row < Calibration::stepRows; ++row) {
            rates.yes[row] = leastRateAt(calibration->bySteps[row], acceptAt);
        }
    }
    if (rejectAt > 0) {
        const float rate = mostRateAt(calibration->whole, rejectAt);
        wholeNo = rate > 0 ? squaredDistanceAt(rate) : wholeNo;
        for (std::size_t row = 0; row < Calibration::stepRows; ++row) {
            rates.no[row] = mostRateAt(calibration->bySteps[row], rejectAt);
        }
    }
    if (acceptAt < 1 && rejectAt > 0) {
        const auto [from, to] = detail::doubtBetween(rejectAt, acceptAt);
        for (std::size_t row = 0; from < to && row < Calibration::stepRows; ++row) {
            rates.doubtFrom[row] = leastRateAt(calibration->bySteps[row], from);
            rates.doubtTo[row] = mostRateAt(calibration->bySteps[row], to);
        }
    }
    onlyNo = rates;
    std::fill(std::begin(onlyNo.yes), std::end(onlyNo.yes), detail::unreachableYes);
}

std::unique_ptr<Query::State> Query::State::copyOf(const State& other) {
    std::unique_ptr<State> copy(new State(other));
    copy->lend();
    return copy;
}

void Query::State::lend() {
    storage.lendTo(descent);
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
    detail::setTrees(descent, *a, *b);
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
        if (limits.calibration != calibration || limits.acceptAt != wanted.acceptAt ||
            limits.rejectAt != wanted.rejectAt) {
            limits.calibration = calibration;
            limits.acceptAt = wanted.acceptAt;
            limits.rejectAt = wanted.rejectAt;
            limits.workOut();
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
            return detail::toOverlap(descent, limit - descent.work);
        }
        const DescentEnd end = nextLeafPair(limit - descent.work);
        if (end != DescentEnd::found) {
            return end;
        }
        leafPending = true;
    }
}

/// At the two whole surfaces, before the first step and as a part of it. True if that is enough.
bool Query::State::lookAtWholes() {
    looking = false;
    if (settings.acceptAt == 1 && settings.rejectAt == 0) {
        return false;
    }
    const float squaredDistance = detail::squaredDistanceOfWholes(a->whole, b->whole, descent.prepared);
    inside = squaredDistance < detail::leastEstimated;
    if (!inside && (squaredDistance <= limits.wholeYes || squaredDistance >= limits.wholeNo)) {
        ++descent.work;
        wholeProbability = probabilityOfWholes(*limits.calibration, squaredDistance);
        return true;
    }
    if (inside && settings.estimateSteps < detail::endlessSteps) {
        handOver();
    }
    return false;
}

/// Estimates in a row that saved nothing, after which all but one of so many are left out.
constexpr std::uint32_t patience = 8;
constexpr std::uint32_t oneOf = 16;

bool Query::State::leavesEstimateOut(const Budget& budget) const {
    return settings.adaptive && fruitless >= patience && fruitless % oneOf != 0 &&
           settings.estimateSteps < detail::endlessSteps && budget.work == unlimited && budget.time == never;
}

void Query::State::handOver() {
    estimating = false;
    ++fruitless;
    exactFrom = descent.work;
    detail::handOver(descent, cut);
}

/// P(they collide) of an answer that is not certain.
float Query::State::collisionProbability() const {
    if (settings.estimateSteps == 0) {
        return 0.5F;
    }
    if (cut.steps == 0) {
        return wholeProbability;
    }
    return estimating
               ? probabilityAfter(*limits.calibration, detail::tunedRate(descent, cut), cut.steps)
               : probabilityAfterwards(*limits.calibration, detail::tunedRate(descent, cut), descent.work - exactFrom);
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
                if (end == DescentEnd::exhausted && looking && units > descent.work - first) {
                    if (lookAtWholes()) {
                        fruitless = 0;
                        end = DescentEnd::budget;
                        sure = true;
                        return true;
                    }
                }
                if (end == DescentEnd::exhausted && estimating) {
                    const auto mostSteps = static_cast<std::uint32_t>(
                        std::min<std::uint64_t>(settings.estimateSteps, detail::endlessSteps));
                    switch (detail::toEstimate(descent, cut, limits.calibration->formula,
                                               ignoreLimits ? detail::noLimits
                                               : inside     ? limits.onlyNo
                                                            : limits.rates,
                                               mostSteps, units - (descent.work - first))) {
                        case EstimateEnd::exhausted:
                            ++fruitless;
                            return true;
                        case EstimateEnd::found:
                            ++fruitless;
                            end = DescentEnd::found;
                            return true;
                        case EstimateEnd::limit:
                            fruitless = 0;
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
        ignoreLimits = ignoreLimits || sure;
        hit = end == DescentEnd::found;
        if (hit) {
            // Unused lanes repeat lane 0, so the lowest lane is a used one.
            const auto lane = static_cast<std::uint32_t>(std::countr_zero(descent.lanes));
            hitTriangles = {detail::blockA(descent, descent.found).triangle[lane >> 2U],
                            detail::blockB(descent, descent.found).triangle[lane & 3U]};
            witness = descent.found;
            hasWitness = true;
        }
    }
    // Made where it goes: a copy of what has just been written in parts would have to wait for them.
    if (finished) {
        return {hit, 1, true, StopReason::certain, descent.work, hit ? hitTriangles : TrianglePair()};
    }
    // Not quite one: that is for what is proven.
    const float probability = std::clamp(collisionProbability(), 1e-6F, 1 - 1e-6F);
    const bool collides = probability >= 0.5F;
    return {collides,     collides ? probability : 1 - probability,
            false,        sure ? StopReason::probability : StopReason::budget,
            descent.work, TrianglePair()};
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
Query::Query(const Query& other) : m_state(other.m_state ? State::copyOf(*other.m_state) : nullptr) {}
Query& Query::operator=(const Query& other) {
    if (this != &other) {
        m_state = other.m_state ? State::copyOf(*other.m_state) : nullptr;
    }
    return *this;
}
Query::Query(Query&&) noexcept = default;
Query& Query::operator=(Query&&) noexcept = default;
Query::~Query() = default;

Decision Query::decide(const Pose& bInA, const DecideSettings& settings, Budget budget) {
    State& state = *m_state;
    if (!state.useSettings(settings) || !state.start(State::Task::decide, bInA, settings.order, 0)) {
        state.task = State::Task::none;
        return {};
    }
    const bool leftOut = settings.estimateSteps > 0 && state.leavesEstimateOut(budget);
    state.fruitless += leftOut ? 1U : 0U;
    state.estimating = settings.estimateSteps > 0 && !leftOut;
    state.hit = false;
    state.looking = state.estimating;
    state.inside = false;
    state.wholeProbability = 0.5F;
    state.ignoreLimits = false;
    detail::startCut(state.cut);
    if (settings.estimateSteps > 0) {
        state.order = Order::depthFirst;
    }
    if (!state.estimating) {
        state.put(detail::sidePair(0, 0), 0);
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
