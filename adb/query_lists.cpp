#include <grapeshot/adb/detail/query_state.hpp>

#include <grapeshot/adb/lane_contact.hpp>
#include <grapeshot/core/detail/leaf_triangles.hpp>

namespace grapeshot {

using detail::DescentEnd;
using detail::SidePair;

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

Contacts Query::contacts(const Pose& bInA, const ContactSettings& settings, Budget budget) {
    Contacts out;
    contacts(bInA, settings, budget, out);
    return out;
}

void Query::contacts(const Pose& bInA, const ContactSettings& settings, Budget budget, Contacts& out) {
    out.pairs.clear();
    out.work = 0;
    if (m_state->start(State::Task::contacts, bInA, settings.order, settings.maxDistance)) {
        m_state->put(detail::sidePair(0, 0), 0);
    }
    resumeContacts(budget, out);
}

void Query::resumeContacts(Budget budget, Contacts& out) {
    m_state->goOn(State::Task::contacts, budget, out,
                  [&](std::uint64_t units) { return m_state->contactsGoOn(units, out); });
}

void Query::leafPairs(const Pose& bInA, const ContactSettings& settings, Budget budget, LeafPairs& out) {
    out.pairs.clear();
    out.work = 0;
    if (m_state->start(State::Task::leafPairs, bInA, settings.order, settings.maxDistance)) {
        m_state->put(detail::sidePair(0, 0), 0);
    }
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
