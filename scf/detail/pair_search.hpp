// The exact traversal of two ball trees from a pair of pieces on: all close pairs of triangles, or the first.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <vector>

#include <grapeshot/scf/detail/pair_batch.hpp>
#include <grapeshot/scf/detail/pair_space.hpp>

namespace grapeshot::detail {

enum class SearchEnd {
    exhausted,  ///< there is no other pair
    stopped,    ///< by whom the pairs were given to
    limited,    ///< the units are used up
};

/// How far beyond the reach all is that was looked at and not found, m. Of what a search has not come to it says
/// nothing.
struct Clearance {
    float room = 0;  ///< farther than that it need not be known
    float least = std::numeric_limits<float>::infinity();
    void limit(float distance) { least = std::min(least, distance); }
};

class PairSearch {
  public:
    /// Every pair of triangles below `start` within reach goes to found(batch, lane) -> bool: go on? Depth first.
    /// @param eager test as soon as there is something to test, nearest pieces first; else only full batches
    /// @param isOver () -> bool: is there nothing left to spend? Asked before every step; the last leaf pair may go
    /// beyond it by its rows (at most 17 units) and its batches
    /// @param clearance if wanted; needs `eager`
    template <class IsOver, class Found>
    SearchEnd runUntil(const PairSpace& space, const BallPair& start, bool eager, IsOver&& isOver, Found&& found,
                       Clearance* clearance = nullptr);
    /// @param limit units
    template <class Found>
    SearchEnd run(const PairSpace& space, const BallPair& start, bool eager, std::uint64_t limit, Found&& found) {
        const std::uint64_t first = m_work;
        return runUntil(
            space, start, eager, [&] { return m_work - first >= limit; }, found);
    }

    /// The triangles of two leaves alone, as they come. False: stopped.
    /// @param clearance if wanted; 0 of what is not eager and has anything to be tested
    template <class Found>
    bool runLeaves(const PairSpace& space, std::uint32_t leafA, std::uint32_t leafB, bool eager, Found&& found,
                   Clearance* clearance = nullptr);
    /// What was not tested yet because it was not eager.
    template <class Found>
    bool finish(const PairSpace& space, Found&& found) {
        return flush(space, found, nullptr);
    }
    void begin() { m_batch.clear(); }
    [[nodiscard]] bool isTested() const { return m_batch.size() == 0; }

    /// The nearest pair that the last `runLeaves` has tested, as far as distances beyond the reach tell; none:
    /// noTriangle.
    [[nodiscard]] const TrianglePair& nearest() const { return m_nearest; }

    [[nodiscard]] std::uint64_t work() const { return m_work; }
    void resetWork() { m_work = 0; }

  private:
    template <class Found>
    bool flush(const PairSpace& space, Found&& found, Clearance* clearance);

    std::vector<BallPair> m_stack;
    PairBatch m_batch;
    TrianglePair m_nearest;
    float m_nearestDistance = 0;
    std::uint64_t m_work = 0;
};

template <class Found>
bool PairSearch::flush(const PairSpace& space, Found&& found, Clearance* clearance) {
    if (m_batch.size() == 0) {
        return true;
    }
    ++m_work;
    const int count = m_batch.run(clearance != nullptr ? space.reach + clearance->room : space.reach);
    for (int lane = 0; lane < count; ++lane) {
        if (m_nearest.triangleA == noTriangle || m_batch.out().signedDistance[lane] < m_nearestDistance) {
            m_nearest = m_batch.pair(lane);
            m_nearestDistance = m_batch.out().signedDistance[lane];
        }
        if (m_batch.out().signedDistance[lane] <= space.reach) {
            if (!found(m_batch, lane)) {
                return false;
            }
        } else if (clearance != nullptr) {
            clearance->limit(std::min(m_batch.out().signedDistance[lane] - space.reach, clearance->room));
        }
    }
    return true;
}

template <class Found>
bool PairSearch::runLeaves(const PairSpace& space, std::uint32_t leafA, std::uint32_t leafB, bool eager, Found&& found,
                           Clearance* clearance) {
    const PosedLeaf& a = space.a->leaf(leafA);
    const PosedLeaf& b = space.b->leaf(leafB);
    const bool same = space.isSelf() && leafA == leafB;
    std::uint16_t row[16];
    m_nearest = {};
    if (clearance == nullptr) {
        m_work += closeRows(a, b, space.reach, space.exclusion, row);
    } else {
        float gap = 0;
        m_work += clearRows(a, b, space.reach, space.exclusion, row, gap);
        clearance->limit(gap);
    }
    const std::uint32_t* const trianglesA = space.a->tree().leaves[leafA].triangle;
    const std::uint32_t* const trianglesB = space.b->tree().leaves[leafB].triangle;
    for (unsigned i = 0; i < 16; ++i) {
        std::uint32_t left = row[i];
        if (same) {
            left &= ~((2U << i) - 1U);
        }
        for (; left != 0U; left &= left - 1U) {
            const auto j = static_cast<unsigned>(std::countr_zero(left));
            if (space.excludes(trianglesA[i], trianglesB[j])) {
                continue;
            }
            m_batch.add(space, a, i, trianglesA[i], b, j, trianglesB[j]);
            if (!eager && clearance != nullptr) {
                clearance->least = 0;
            }
            if (m_batch.isFull() && !flush(space, found, eager ? clearance : nullptr)) {
                m_batch.clear();
                return false;
            }
        }
    }
    if (eager && !flush(space, found, clearance)) {
        return false;
    }
    return true;
}

template <class IsOver, class Found>
SearchEnd PairSearch::runUntil(const PairSpace& space, const BallPair& start, bool eager, IsOver&& isOver,
                               Found&& found, Clearance* clearance) {
    m_batch.clear();
    m_stack.clear();
    m_stack.push_back(start);
    ChildPairs children;
    float weight[16];
    float gap[16];
    while (!m_stack.empty()) {
        if (isOver()) {
            return SearchEnd::limited;
        }
        const BallPair pair = m_stack.back();
        m_stack.pop_back();
        if (isBallLeaf(pair.a) && isBallLeaf(pair.b)) {
            if (!runLeaves(space, ballIndex(pair.a), ballIndex(pair.b), eager, found, clearance)) {
                return SearchEnd::stopped;
            }
            continue;
        }
        if (clearance == nullptr) {
            m_work += space.expand(pair, children, eager ? &weight : nullptr);
        } else {
            float beyond = 0;
            m_work += space.expandWithin(pair, 0, children, gap, weight, beyond);
            clearance->limit(beyond);
        }
        unsigned nearest = 16;
        for (std::uint32_t left = children.mask; left != 0U; left &= left - 1U) {
            const auto lane = static_cast<unsigned>(std::countr_zero(left));
            if (eager && (nearest == 16 || weight[lane] > weight[nearest])) {
                nearest = lane;
            }
            m_stack.push_back(children.at(lane));
        }
        if (nearest < 16) {
            const auto below = static_cast<std::size_t>(std::popcount(children.mask >> nearest));
            std::swap(m_stack.back(), m_stack[m_stack.size() - below]);
        }
    }
    if (m_batch.size() > 0 && isOver()) {
        return SearchEnd::limited;
    }
    return flush(space, found, clearance) ? SearchEnd::exhausted : SearchEnd::stopped;
}

}  // namespace grapeshot::detail
