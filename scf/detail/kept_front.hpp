// The traversal down to a cut by what is remembered of the one before, so that it looks only where something may have
// changed.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <vector>

#include <grapeshot/scf/detail/front_memory.hpp>
#include <grapeshot/scf/detail/pair_space.hpp>
#include <grapeshot/scf/detail/prefetch.hpp>

namespace grapeshot::detail {

class KeptFront {
  public:
    /// @param nearer m, see `nearerThanBefore`; infinite: it begins anew
    /// @param skin m: what is less than so much beyond the reach is opened nevertheless, so that its parent need not be
    /// looked at again at once
    void begin(const std::vector<FrontRecord>& before, float nearer, float skin);

    /// visit(pair, weight, record, slack) -> bool: go on? For every pair at the end, but those that are known to be
    /// clear and by more than the skin (`slack`, m). None that has a pair of triangles within reach is left out if the
    /// run goes to the end. Of a body with itself each pair comes once, the first cell first. `setSlack` tells what a
    /// visit has learnt.
    /// @param isEnd (BallRef, side 0 or 1) -> bool: is this piece not opened?
    /// @param mayGoOn () -> bool, asked before every look at a pair
    /// @return did it go to the end? What it did not come to is kept as it was
    template <class IsEnd, class Visit, class MayGoOn>
    bool run(const PairSpace& space, std::uint64_t& work, IsEnd&& isEnd, Visit&& visit, MayGoOn&& mayGoOn);

    void setSlack(std::uint32_t record, float slack) { m_records[record].slack = slack; }
    /// For the next step. What was there before is lost.
    void moveTo(std::vector<FrontRecord>& records) { records.swap(m_records); }
    [[nodiscard]] std::uint32_t kept() const { return m_kept; }
    [[nodiscard]] std::uint32_t opened() const { return m_opened; }

  private:
    static constexpr std::uint32_t none = 0xffffffffU;
    static constexpr unsigned recordsPerUnit = 16;

    [[nodiscard]] float slackNow(std::uint32_t old) const { return (*m_before)[old].slack - m_nearer; }
    /// The record of a pair among those from `next` to `end`, which stand beside each other.
    [[nodiscard]] std::uint32_t find(const BallPair& pair, std::uint32_t& next, std::uint32_t end) const;
    void keepBelow(std::uint32_t old);
    void count(std::uint64_t& work) { work += ++m_looked % recordsPerUnit == 0 ? 1 : 0; }

    template <class IsEnd, class Visit, class MayGoOn>
    struct Run;

    const std::vector<FrontRecord>* m_before = nullptr;
    std::vector<FrontRecord> m_records;
    float m_nearer = 0;
    float m_skin = 0;
    std::uint32_t m_kept = 0;    ///< that were not looked at again
    std::uint32_t m_opened = 0;  ///< that were, having been known
    std::uint32_t m_looked = 0;
};

template <class IsEnd, class Visit, class MayGoOn>
struct KeptFront::Run {
    KeptFront& front;
    const PairSpace& space;
    std::uint64_t& work;
    IsEnd& isEnd;
    Visit& visit;
    MayGoOn& mayGoOn;
    bool stopped = false;

    /// @param gap m, of the balls, if they were looked at just now
    void comeTo(const BallPair& pair, float weight, float gap, std::uint32_t old);
    void open(const BallPair& pair, std::uint32_t old, bool wholeA, bool wholeB);
};

template <class IsEnd, class Visit, class MayGoOn>
void KeptFront::Run<IsEnd, Visit, MayGoOn>::comeTo(const BallPair& pair, float weight, float gap, std::uint32_t old) {
    if (stopped) {
        if (old != none) {
            front.keepBelow(old);
        }
        return;
    }
    // The root is opened even if it is small enough to be a cell.
    const bool endA = pair.a != 0 && isEnd(pair.a, 0);
    const bool endB = pair.b != 0 && isEnd(pair.b, 1);
    if (!endA || !endB) {
        open(pair, old, endA, endB);
        return;
    }
    front.count(work);
    const float slack = std::max(gap, old != none ? front.slackNow(old) : 0);
    const auto record = static_cast<std::uint32_t>(front.m_records.size());
    front.m_records.push_back({pair, 1, slack, weight, true});
    if (old != none && (*front.m_before)[old].slack > 0) {
        ++(slack > 0 ? front.m_kept : front.m_opened);
    }
    if (slack > 0) {
        stopped = slack <= front.m_skin && !visit(pair, weight, record, slack);
    } else {
        stopped = !mayGoOn() || !visit(pair, weight, record, slack);
    }
}

template <class IsEnd, class Visit, class MayGoOn>
void KeptFront::Run<IsEnd, Visit, MayGoOn>::open(const BallPair& pair, std::uint32_t old, bool wholeA, bool wholeB) {
    const std::vector<FrontRecord>& before = *front.m_before;
    const auto record = static_cast<std::uint32_t>(front.m_records.size());
    std::uint32_t next = old == none ? 0 : old + 1;
    const std::uint32_t end = old == none ? 0 : old + before[old].size;
    if (old != none && front.slackNow(old) > 0) {
        front.count(work);
        ++front.m_kept;
        front.m_records.push_back({pair, 1, front.slackNow(old), 0, false});
        for (; next < end; next += before[next].size) {
            comeTo(before[next].pair, before[next].weight, 0, next);
        }
    } else if (!mayGoOn()) {
        stopped = true;
        if (old != none) {
            front.keepBelow(old);
        }
        return;
    } else {
        front.m_opened += old != none ? 1 : 0;
        front.m_records.push_back({pair, 1, 0, 0, false});
        ChildPairs children;
        float gap[16];
        float weight[16];
        float slack = 0;
        work += space.expandWithin(pair, front.m_skin, children, gap, weight, slack, wholeA, wholeB);
        prefetchChildren(space, children);
        float overlap = 0;
        for (std::uint32_t left = children.mask; left != 0U;) {
            const auto lane = static_cast<unsigned>(std::bit_width(left)) - 1;
            left &= ~(1U << lane);
            if (left != 0U) {
                prefetchPoints(space, children.at(static_cast<unsigned>(std::bit_width(left)) - 1));
            }
            overlap = std::max(overlap, -gap[lane]);
            comeTo(children.at(lane), weight[lane], std::max(gap[lane], 0.0F),
                   front.find(children.at(lane), next, end));
        }
        // Weights want to be fresh, and what has parted to be closed.
        constexpr float freshness = 0.25F;
        front.m_records[record].slack = stopped ? 0 : overlap > 0 ? std::min(slack, freshness * overlap) : slack;
    }
    front.m_records[record].size = static_cast<std::uint32_t>(front.m_records.size()) - record;
}

inline void KeptFront::begin(const std::vector<FrontRecord>& before, float nearer, float skin) {
    m_before = &before;
    m_records.clear();
    m_nearer = nearer;
    m_skin = skin;
    m_kept = m_opened = m_looked = 0;
}

inline std::uint32_t KeptFront::find(const BallPair& pair, std::uint32_t& next, std::uint32_t end) const {
    for (std::uint32_t i = next; i < end; i += (*m_before)[i].size) {
        if ((*m_before)[i].pair == pair) {
            next = i + (*m_before)[i].size;
            return i;
        }
    }
    return none;
}

inline void KeptFront::keepBelow(std::uint32_t old) {
    const auto first = m_before->begin() + old;
    for (auto one = first; one != first + first->size; ++one) {
        m_records.push_back(*one);
        m_records.back().slack -= m_nearer;
    }
}

template <class IsEnd, class Visit, class MayGoOn>
bool KeptFront::run(const PairSpace& space, std::uint64_t& work, IsEnd&& isEnd, Visit&& visit, MayGoOn&& mayGoOn) {
    Run<std::remove_reference_t<IsEnd>, std::remove_reference_t<Visit>, std::remove_reference_t<MayGoOn>> run{
        *this, space, work, isEnd, visit, mayGoOn};
    run.comeTo({0, 0}, 1, 0, m_before->empty() || !(m_nearer < std::numeric_limits<float>::infinity()) ? none : 0);
    return !run.stopped;
}

}  // namespace grapeshot::detail
