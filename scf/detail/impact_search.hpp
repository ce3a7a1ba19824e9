// The first impact of two ball trees in motion: by time, and by a uniform sample of what is left.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <grapeshot/core/random.hpp>
#include <grapeshot/scf/continuous.hpp>
#include <grapeshot/scf/detail/impact_batch.hpp>
#include <grapeshot/scf/detail/meter.hpp>

namespace grapeshot::detail {

/// Two pieces (BallRef) or two triangles (as LanePair has them) that do not touch before `time`.
struct WaitingPair {
    float time = 0;
    std::uint32_t a = 0;
    std::uint32_t b = 0;
    float promise = 0;  ///< larger: an impact is likelier
    /// Of those of the same time leaves come first and deeper nodes before the others, so that few wait.
    friend bool operator<(const WaitingPair& x, const WaitingPair& y) {
        return x.time != y.time ? x.time > y.time : x.a != y.a ? x.a < y.a : x.b < y.b;
    }
};

inline void put(std::vector<WaitingPair>& heap, const WaitingPair& pair) {
    heap.push_back(pair);
    std::push_heap(heap.begin(), heap.end());
}

[[nodiscard]] inline WaitingPair take(std::vector<WaitingPair>& heap) {
    std::pop_heap(heap.begin(), heap.end());
    const WaitingPair earliest = heap.back();
    heap.pop_back();
    return earliest;
}

/// Everything that may touch before the limit lies in one of the pairs. Both are heaps, with the earliest on top unless
/// the order is by promise.
struct ImpactFront {
    std::vector<WaitingPair> pieces, triangles;
    bool isByPromise = false;

    [[nodiscard]] std::size_t size() const { return pieces.size() + triangles.size(); }
    /// Is a call for triangle pairs the next step? Else a piece is opened.
    [[nodiscard]] bool isForTriangles() const;
    /// O(n) if it was another.
    void order(bool byPromise);
    void putInOrder(std::vector<WaitingPair>& heap, const WaitingPair& pair) const;
    [[nodiscard]] WaitingPair takeInOrder(std::vector<WaitingPair>& heap) const;
    void clear() {
        pieces.clear();
        triangles.clear();
        isByPromise = false;
    }
};

/// How a search by time goes on, whatever it looks for.
namespace impacts {
inline constexpr float afterTheEnd = 1.000001F;  // a touch at the very end counts
inline constexpr float smallestStep = 2.4e-7F;   // of the part: below it time hardly goes on
inline constexpr float timeRounding = 1 - 1.2e-7F;
inline constexpr std::size_t worthACall = 6;  // triangle pairs that are due before the next piece
inline constexpr int roundsInARow = 4;
inline constexpr double priceOfASample = 24;  // units, more than most cost
inline constexpr double caution = 0.75;       // what is not finished counts as a hit
inline constexpr float promiseOfALeaf = 0.1F;
inline constexpr std::uint64_t firstPeriod = 64;      // units; each one after it ends at twice as many
inline constexpr std::uint64_t promisedUnits = 1024;  // ... and from here on there is only time
}  // namespace impacts

/// Memory that is worth keeping.
struct ImpactScratch {
    ImpactFront front, side;
    ImpactBatch batch;
};

class ImpactSearch {
  public:
    /// @param spent units, of the same budget
    ImpactSearch(const ImpactSpace& space, Meter& meter, const RandomKey& key, std::uint32_t firstDraw,
                 std::uint64_t spent, ImpactScratch& scratch);

    /// Until there is nothing earlier than the limit, or less than `spare` units are left. True: exhausted. By time;
    /// but with a limited budget for bodies that go far, what promises an impact comes first most of the time until one
    /// is known: earlier ones are proven absent later. The order does not depend on how large the budget is.
    bool run(std::uint64_t spare);
    /// Searches a uniform sample of what waits.
    void audit(MissEstimate& miss);

    /// Does nothing wait? Then the impact is the first, or there is none.
    [[nodiscard]] bool isExhausted() const { return m_scratch.front.size() == 0; }
    [[nodiscard]] const std::optional<Impact>& impact() const { return m_impact; }
    /// Nothing touches before.
    [[nodiscard]] float freeUntil() const;
    [[nodiscard]] std::uint64_t work() const { return m_work; }

  private:
    bool run(ImpactFront& front, std::uint64_t spare);
    [[nodiscard]] bool isForPromise() const;
    void open(ImpactFront& front);
    void openLeaves(ImpactFront& front, const WaitingPair& leaves);
    void advanceEarliest(ImpactFront& front);
    void dropLate(ImpactFront& front) const;
    [[nodiscard]] bool hasMoreThan(std::uint64_t spare);

    const ImpactSpace& m_space;
    Meter& m_meter;
    ImpactScratch& m_scratch;
    RandomKey m_key;
    std::uint32_t m_draw;
    std::uint64_t m_begin;
    std::uint64_t m_work;
    bool m_isHasty;
    std::optional<Impact> m_impact;
    float m_limit;  ///< nothing later is of interest
};

}  // namespace grapeshot::detail
