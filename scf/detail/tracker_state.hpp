// What a tracker remembers, and what it works with.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <grapeshot/scf/detail/cells.hpp>
#include <grapeshot/scf/detail/front.hpp>
#include <grapeshot/scf/detail/front_memory.hpp>
#include <grapeshot/scf/detail/impact_search.hpp>
#include <grapeshot/scf/detail/kept_front.hpp>
#include <grapeshot/scf/detail/key_map.hpp>
#include <grapeshot/scf/detail/pair_search.hpp>
#include <grapeshot/scf/detail/posed_tree.hpp>
#include <grapeshot/scf/tracker.hpp>

namespace grapeshot::detail {

/// Of a step's budget, for what is known already.
inline constexpr double trackedShare = 0.6;

struct TrackedPair {
    TrianglePair pair;
    std::uint64_t birth = 0;  ///< step
    friend bool operator==(const TrackedPair&, const TrackedPair&) = default;
};

/// All that is saved.
struct TrackerMemory {
    std::vector<TrackedPair> tracked;  ///< those that wait longest for a test first
    std::uint64_t step = 0;
    float testPrice = 32;  ///< units, mean of late, for a pair of cells in the sample for the bound
    FrontMemory front;
};

/// A pair that is followed.
struct NearPair {
    TrackedPair tracked;
    std::optional<TrackedContact> ahead;  ///< if it is
};

/// A pair of cells of the front.
struct Candidate {
    BallPair cells;
    float weight = 0;
    bool isAhead = false;      ///< known to be clear
    std::uint32_t record = 0;  ///< of the front that is kept
};

/// Made anew in every step, or from the trees: a copy of the tracker need not have it.
struct TrackerScratch {
    TrackerScratch(const BallTree& treeA, const BallTree& treeB, bool oneBody) : a(treeA) {
        if (!oneBody) {
            b.emplace(treeB);
        }
    }
    PosedTree a;
    std::optional<PosedTree> b;                  ///< not of a body with itself
    std::optional<MovingTree> movingA, movingB;  ///< from the first continuous step on
    ImpactScratch impact;
    Cells spacingA, spacingB, frontA, frontB;
    CellNeighbours aroundA, aroundB;  ///< of the cells of the spacing
    float spacing = -1;
    std::uint32_t frontCells = 0;

    PairSearch search;
    PairBatch batch;
    Front front;
    KeptFront keptFront;
    KeyMap contacts;   ///< by key, to the index in the result
    KeyMap nearPairs;  ///< likewise, of those that are followed
    KeyMap tried;      ///< pairs of cells of the spacing's size that have a contact or were looked into
    KeyMap reported;   ///< pairs of cells of the front that have a contact listed
    KeyMap found;      ///< by key: by how many dives
    std::vector<TrackedPair> kept;
    std::vector<NearPair> near;
    std::vector<Candidate> candidates;
    std::vector<double> cumulative;
    std::vector<std::uint32_t> unknown;
    std::vector<std::uint32_t> toWalk;
};

}  // namespace grapeshot::detail
