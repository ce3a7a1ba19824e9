// What the paper leaves to the application, what its three printed versions do differently, and the switches that take
// a single assumption out.
//
// This work is based on:
// Jan Klein, Gabriel Zachmann. ADB-Trees: Controlling the Error of Time-Critical Collision Detection. VMV 2003
// Gabriel Zachmann. Collision Detection as a Fundamental Technology in VR Based Product Engineering. 2007, fig. 10
// Matthias Teschner et al. Collision Detection for Deformable Objects. Eurographics STAR 2004, section on stochastic
// methods
#pragma once

#include <cstddef>
#include <limits>

namespace grapeshot::reference {

/// How full a cell must be: at build time.
struct FillSettings {
    int grid = 4;      ///< cells per side of a node's box, 1 to 16; the paper says "a fixed number"
    double tau = 0.3;  ///< > 0: a cell counts from tau * MaxArea on; 1 is the definition by the letter, 0.3 fitted
};

/// Which child pairs are put into the queue.
enum class Insert {
    positive,     ///< p > 0 (chapter and STAR): loses pairs of which one side has no well-filled cell
    overlapping,  ///< p >= 0, read as: all whose volumes overlap
    everything,   ///< p >= 0 by the letter: always true, so a clear pair of bodies costs all pairs of nodes
};

/// What happens to two leaves.
enum class LeafPairs {
    drop,       ///< as printed: a leaf has no children, so the pair is gone when it is taken up
    testExact,  ///< their triangles are tested, and an intersection is the answer
};

/// What happens to a leaf and an inner node.
enum class UnequalPairs {
    drop,         ///< as printed: no child of one, so no pair of children
    descendInner  ///< the leaf with both children of the other
};

/// LB, the probability that one collision cell holds a collision.
enum class LowerBound {
    depth,      ///< (d_A + d_B) / (d_maxA + d_maxB), the paper's stand-in for flatness
    curvature,  ///< of planar patches at this tau, less what the normal cone of the node takes away
};

struct Settings {
    double pMin = 0.99;  ///< 0 to 1: a pair with p >= pMin is evidence
    int kMin = 10;       ///< >= 1: so many pieces of evidence are a collision
    int mostCells = 10;  ///< 1 to 10: eq. 9 looks at x up to here
    Insert insert = Insert::positive;
    LeafPairs leafPairs = LeafPairs::drop;
    UnequalPairs unequalPairs = UnequalPairs::drop;
    LowerBound lowerBound = LowerBound::depth;
    /// As printed, a pair that counted goes into the queue all the same, and its children count again.
    bool nestedEvidence = true;
    /// Pairs taken from the queue before it gives up and says no: the paper's time budget, in counts.
    std::size_t mostPairs = std::numeric_limits<std::size_t>::max();
};

/// The lecture slides: first p >= pMin ends it, inserts if p >= 0.
[[nodiscard]] Settings slide();
/// The book chapter of 2007 (all its plots): kMin 10, pMin 0.99, inserts if p > 0.
[[nodiscard]] Settings chapter2007();
/// The STAR of 2004: no kMin, inserts if p > 0.
[[nodiscard]] Settings star();

/// @throws Error badSetting that names the field, its value and its range
void requireUsable(const FillSettings& settings);
void requireUsable(const Settings& settings);

}  // namespace grapeshot::reference
