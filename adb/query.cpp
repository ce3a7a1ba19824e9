#include <grapeshot/adb/query.hpp>

#include <bit>
#include <limits>

#include <grapeshot/adb/detail/descent.hpp>
#include <grapeshot/adb/detail/pair_queue.hpp>
#include <grapeshot/adb/detail/spending.hpp>
#include <grapeshot/adb/lane_contact.hpp>
#include <grapeshot/core/detail/leaf_triangles.hpp>

namespace grapeshot {

using detail::DescentEnd;
using detail::SidePair;

struct Query::State {
    enum class Task { none, decide, contacts, leafPairs };

    State(const Tree& treeA, const Tree& treeB) : a(&treeA), b(&treeB), storage(512) { lend(); }
    State(const State& other)
        : a(other.a),
          b(other.b),
          descent(other.descent),
          storage(other.storage),
          queue(other.queue),
          task(other.task),
          order(other.order),
          maxDistance(other.maxDistance),
          finished(other.finished),
          leafPending(other.leafPending),
          witness(other.witness),
          hasWitness(other.hasWitness),
          decision(other.decision) {
        lend();
    }
    State& operator=(const State&) = delete;
    ~State() = default;

    bool start(Task newTask, const Pose& bInA, Order newOrder, float distance);
    void put(SidePair pair, float margin);
    DescentEnd nextLeafPair(std::uint64_t units);
    DescentEnd nextOverlap(std::uint64_t units);
    void tryWitness();
    Decision goOn(const Budget& budget);
    bool contactsGoOn(std::uint64_t units, Contacts& out);
    void append(const LeafBlock& blockA, const LeafBlock& blockB, Contacts& out) const;
    template <typename Result, typename Run>
    void goOn(Task which, const Budget& budget, Result& out, const Run& run);

    /// The descent works on borrowed memory, because code compiled per instruction set calls nothing of the standard
    /// library.
    void lend() {
        descent.stack = storage.data();
        descent.capacity = storage.size();
        descent.owner = this;
        descent.grow = [](detail::Descent& borrower) {
            auto& state = *static_cast<State*>(borrower.owner);
            state.storage.resize(2 * state.storage.size());
            state.lend();
        };
    }

    const Tree* a;
    const Tree* b;
    detail::Descent descent;
    std::vector<SidePair> storage;
    detail::PairQueue queue;
    Task task = Task::none;
    Order order = Order::depthFirst;
    float maxDistance = 0;
    bool finished = false;     ///< the answer is certain
    bool leafPending = false;  ///< descent.found is a leaf pair still to be tested
    SidePair witness = 0;
    bool hasWitness = false;
    Decision decision;
};

/// To the root. False if the input is invalid: then there is nothing to go on with.
bool Query::State::start(Task newTask, const Pose& bInA, Order newOrder, float distance) {
    task = Task::none;
    finished = false;
    leafPending = false;
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
    descent.leavesA = a->leaves.data();
    descent.leavesB = b->leaves.data();
    if (!finished) {
        put(detail::sidePair(0, 0), 0);
    }
    return true;
}

void Query::State::put(SidePair pair, float margin) {
    if (order == Order::bestFirst) {
        queue.push(pair, margin);
    } else {
        descent.stack[descent.depth++] = pair;  // the root and a witness: there is always room
    }
}

/// DescentEnd::found: the pair is descent.found.
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

DescentEnd Query::State::nextOverlap(std::uint64_t units) {
    if (order == Order::depthFirst) {
        return detail::toOverlap(descent, units);
    }
    const std::uint64_t limit = units > unlimited - descent.work ? unlimited : descent.work + units;
    for (;;) {
        if (!leafPending) {
            const DescentEnd end = nextLeafPair(limit - descent.work);
            if (end != DescentEnd::found) {
                return end;
            }
            leafPending = true;
        }
        if (descent.work == limit) {
            return DescentEnd::budget;
        }
        leafPending = false;
        ++descent.work;
        descent.lanes = detail::overlapsLeaves(detail::blockA(descent, descent.found).corner,
                                               detail::blockB(descent, descent.found).corner, descent.pose);
        if (descent.lanes != 0) {
            return DescentEnd::found;
        }
    }
}

/// The witness of the last decision is taken up before the root. If it does not hit this time it is forgotten: bodies
/// that have parted would pay for it in each query.
void Query::State::tryWitness() {
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
        put(witness, std::numeric_limits<float>::infinity());
    }
}

Decision Query::State::goOn(const Budget& budget) {
    if (!finished) {
        DescentEnd end = DescentEnd::budget;
        finished = detail::spend(
            budget, [this] { return descent.work; },
            [&](std::uint64_t units) {
                end = nextOverlap(units);
                return end != DescentEnd::budget;
            });
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
            decision.collides = !finished;
        }
    }
    decision.certain = finished;
    decision.probability = finished ? 1.0F : 0.5F;
    decision.stop = finished ? StopReason::certain : StopReason::budget;
    return decision;
}

/// True when all leaf pairs are done.
bool Query::State::contactsGoOn(std::uint64_t units, Contacts& out) {
    const std::uint64_t limit = units > unlimited - descent.work ? unlimited : descent.work + units;
    for (;;) {
        if (!leafPending) {
            const DescentEnd end = nextLeafPair(limit - descent.work);
            if (end != DescentEnd::found) {
                return end == DescentEnd::exhausted;
            }
            leafPending = true;
        }
        if (descent.work == limit) {
            return false;
        }
        leafPending = false;
        ++descent.work;
        append(detail::blockA(descent, descent.found), detail::blockB(descent, descent.found), out);
    }
}

void Query::State::append(const LeafBlock& blockA, const LeafBlock& blockB, Contacts& out) const {
    DistanceBatch batch;
    detail::signedDistancesLeaves(blockA.corner, blockB.corner, descent.pose, batch);
    for (std::uint32_t lane = 0; lane < batchWidth; ++lane) {
        const TrianglePair pair{blockA.triangle[lane >> 2U], blockB.triangle[lane & 3U]};
        if (pair.triangleA == noTriangle || pair.triangleB == noTriangle ||
            !(batch.signedDistance[lane] <= maxDistance)) {
            continue;
        }
        out.pairs.push_back(laneContact(batch, lane, pair));
    }
}

/// Shared by the listing tasks: checks that `which` is under way, runs it, fills in what is told of the end.
template <typename Result, typename Run>
void Query::State::goOn(Task which, const Budget& budget, Result& out, const Run& run) {
    if (task != which) {
        out.certain = false;
        out.stop = StopReason::invalidInput;
        return;
    }
    finished = finished || detail::spend(
                               budget, [this] { return descent.work; }, run);
    out.work = descent.work;
    out.certain = finished;
    out.stop = finished ? StopReason::certain : StopReason::budget;
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
    if (!state.start(State::Task::decide, bInA, settings.order, 0)) {
        return state.decision;
    }
    state.tryWitness();
    return state.goOn(budget);
}

Decision Query::resume(Budget budget) {
    return m_state->task == State::Task::decide ? m_state->goOn(budget) : Decision();
}

Contacts Query::contacts(const Pose& bInA, const ContactSettings& settings, Budget budget) {
    Contacts out;
    contacts(bInA, settings, budget, out);
    return out;
}

void Query::contacts(const Pose& bInA, const ContactSettings& settings, Budget budget, Contacts& out) {
    out.pairs.clear();
    out.work = 0;
    m_state->start(State::Task::contacts, bInA, settings.order, settings.maxDistance);
    resumeContacts(budget, out);
}

void Query::resumeContacts(Budget budget, Contacts& out) {
    m_state->goOn(State::Task::contacts, budget, out,
                  [&](std::uint64_t units) { return m_state->contactsGoOn(units, out); });
}

void Query::leafPairs(const Pose& bInA, const ContactSettings& settings, Budget budget, LeafPairs& out) {
    out.pairs.clear();
    out.work = 0;
    m_state->start(State::Task::leafPairs, bInA, settings.order, settings.maxDistance);
    resumeLeafPairs(budget, out);
}

void Query::resumeLeafPairs(Budget budget, LeafPairs& out) {
    m_state->goOn(State::Task::leafPairs, budget, out, [&](std::uint64_t units) {
        const std::uint64_t first = m_state->descent.work;
        for (;;) {
            const DescentEnd end = m_state->nextLeafPair(units - (m_state->descent.work - first));
            if (end != DescentEnd::found) {
                return end == DescentEnd::exhausted;
            }
            const SidePair pair = m_state->descent.found;
            out.pairs.push_back({detail::leafOf(m_state->descent.nodesA, detail::sideA(pair)),
                                 detail::leafOf(m_state->descent.nodesB, detail::sideB(pair))});
        }
    });
}

void Query::contactsOf(std::span<const LeafPair> pairs, const Pose& bInA, float maxDistance, Budget budget,
                       Contacts& out) {
    State& state = *m_state;
    out = Contacts{std::move(out.pairs), false, StopReason::invalidInput, 0};
    out.pairs.clear();
    for (const LeafPair& pair : pairs) {
        if (pair.leafA >= state.a->leaves.size() || pair.leafB >= state.b->leaves.size()) {
            return;
        }
    }
    if (!state.start(State::Task::contacts, bInA, Order::depthFirst, maxDistance)) {
        return;
    }
    state.task = State::Task::none;
    bool done = state.finished;
    if (!done) {
        std::uint64_t next = 0;
        done = detail::spend(
            budget, [&] { return next; },
            [&](std::uint64_t units) {
                for (; units > 0 && next < pairs.size(); --units, ++next) {
                    state.append(state.a->leaves[pairs[next].leafA], state.b->leaves[pairs[next].leafB], out);
                }
                return next == pairs.size();
            });
        out.work = next;
    }
    out.certain = done;
    out.stop = done ? StopReason::certain : StopReason::budget;
}

}  // namespace grapeshot
