// The time-critical traversal: pairs of nodes by probability, no polygons.
//
// This work is based on:
// Jan Klein, Gabriel Zachmann. ADB-Trees: Controlling the Error of Time-Critical Collision Detection. VMV 2003
// Gabriel Zachmann. Collision Detection as a Fundamental Technology in VR Based Product Engineering. 2007, fig. 10
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <grapeshot/adb/reference/leaf_test.hpp>
#include <grapeshot/adb/reference/probability.hpp>
#include <grapeshot/adb/reference/settings.hpp>
#include <grapeshot/adb/reference/tree.hpp>

namespace grapeshot::reference {

enum class Ending {
    rootsDisjoint,  ///< the outermost volumes do not overlap: certain
    evidence,       ///< kMin pairs with p >= pMin
    triangles,      ///< an intersecting pair of triangles (LeafPairs::testExact): certain
    queueEmpty,     ///< nothing left: "no collision"
    gaveUp,         ///< mostPairs
};

struct Answer {
    bool collides = false;
    Ending ending = Ending::rootsDisjoint;
    int evidence = 0;       ///< k
    std::size_t pairs = 0;  ///< taken from the queue
    std::size_t volumeTests = 0;
    std::size_t estimates = 0;  ///< calls of computeProb
    std::size_t triangleTests = 0;
};

/// Keeps references to the trees and the counts. Trees of the two bodies may differ, the kind of volume not.
template <BoundingVolume V>
class AdbQuery {
  public:
    struct Body {
        const BoundedTree<V>& tree;
        const CellCounts& cells;
    };

    /// @throws Error badSetting
    AdbQuery(const Body& a, const Body& b, const Settings& settings) : m_a(a), m_b(b), m_settings(settings) {
        requireUsable(settings);
    }

    /// @throws Error notFinite, notRigid
    [[nodiscard]] Answer decide(const Pose& bInA) {
        const Placement placement(bInA);
        const typename V::PairTest test(placement);
        Answer answer{.volumeTests = 1};
        if (test.disjoint(m_a.tree.volumes[0], m_b.tree.volumes[0])) {
            return answer;
        }
        m_queue.clear();
        push({1, m_a.tree.extents[0].volume, 0, 0});  // q.insert(A, B, 1)
        while (!m_queue.empty()) {
            if (answer.pairs == m_settings.mostPairs) {
                answer.ending = Ending::gaveUp;
                return answer;
            }
            const Entry pair = pop();
            ++answer.pairs;
            if (expand(pair, placement, test, answer)) {
                answer.collides = true;
                return answer;
            }
        }
        answer.ending = Ending::queueEmpty;
        return answer;
    }

  private:
    struct Entry {
        double p;
        double volume;  ///< of A's node: the larger first among equals
        std::uint32_t a;
        std::uint32_t b;
        friend bool operator<(const Entry& x, const Entry& y) { return x.p != y.p ? x.p < y.p : x.volume < y.volume; }
    };

    void push(const Entry& entry) {
        m_queue.push_back(entry);
        std::push_heap(m_queue.begin(), m_queue.end());
    }
    Entry pop() {
        std::pop_heap(m_queue.begin(), m_queue.end());
        const Entry entry = m_queue.back();
        m_queue.pop_back();
        return entry;
    }

    /// Whether that was the answer "collision".
    bool expand(const Entry& pair, const Placement& placement, const typename V::PairTest& test, Answer& answer) {
        const TreeNode& nodeA = m_a.tree.hierarchy.nodes[pair.a];
        const TreeNode& nodeB = m_b.tree.hierarchy.nodes[pair.b];
        if (nodeA.isLeaf() && nodeB.isLeaf()) {
            if (m_settings.leafPairs == LeafPairs::testExact &&
                leavesOverlap(m_a.tree.hierarchy, nodeA, m_b.tree.hierarchy, nodeB, placement, answer.triangleTests)) {
                answer.ending = Ending::triangles;
                return true;
            }
            return false;
        }
        if ((nodeA.isLeaf() || nodeB.isLeaf()) && m_settings.unequalPairs == UnequalPairs::drop) {
            return false;
        }
        const std::uint32_t firstA = nodeA.isLeaf() ? pair.a : nodeA.left;
        const std::uint32_t lastA = nodeA.isLeaf() ? pair.a : nodeA.left + 1;
        const std::uint32_t firstB = nodeB.isLeaf() ? pair.b : nodeB.left;
        const std::uint32_t lastB = nodeB.isLeaf() ? pair.b : nodeB.left + 1;
        for (std::uint32_t a = firstA; a <= lastA; ++a) {
            for (std::uint32_t b = firstB; b <= lastB; ++b) {
                ++answer.volumeTests;
                const bool overlapping = !test.disjoint(m_a.tree.volumes[a], m_b.tree.volumes[b]);
                if (!overlapping && m_settings.insert != Insert::everything) {
                    continue;
                }
                ++answer.estimates;
                const double p = overlapping ? computeProb(a, b, placement) : 0;
                const bool isEvidence = p >= m_settings.pMin;
                if (isEvidence && ++answer.evidence >= m_settings.kMin) {
                    answer.ending = Ending::evidence;
                    return true;
                }
                if ((p > 0 || m_settings.insert != Insert::positive) && (!isEvidence || m_settings.nestedEvidence)) {
                    push({p, m_a.tree.extents[a].volume, a, b});
                }
            }
        }
        return false;
    }

    [[nodiscard]] double computeProb(std::uint32_t a, std::uint32_t b, const Placement& placement) const {
        const int wellFilledA = m_a.cells.wellFilled[a];
        const int wellFilledB = m_b.cells.wellFilled[b];
        if (wellFilledA == 0 || wellFilledB == 0) {
            return 0;  // eq. 8 with an empty colour
        }
        const Extent& extentA = m_a.tree.extents[a];
        const Extent& extentB = m_b.tree.extents[b];
        const double distance = (placement.toA(m_b.tree.centers[b]) - m_a.tree.centers[a]).norm();
        const SharedCells shared =
            sharedCells({&extentA, wellFilledA, m_a.cells.settings.grid},
                        {&extentB, wellFilledB, m_b.cells.settings.grid}, sharedVolume<V>(extentA, extentB, distance));
        return collisionProbability(m_table(shared.s, shared.sA, shared.sB), lowerBound(a, b), m_settings.mostCells);
    }

    [[nodiscard]] double lowerBound(std::uint32_t a, std::uint32_t b) const {
        const Hierarchy& hierarchyA = m_a.tree.hierarchy;
        const Hierarchy& hierarchyB = m_b.tree.hierarchy;
        const TreeNode& nodeA = hierarchyA.nodes[a];
        const TreeNode& nodeB = hierarchyB.nodes[b];
        if (m_settings.lowerBound == LowerBound::depth) {
            return depthBound(nodeA.depth, nodeB.depth, hierarchyA.maxDepth, hierarchyB.maxDepth);
        }
        return curvatureBound(std::min(m_a.cells.settings.tau, m_b.cells.settings.tau),
                              std::max(nodeA.coneHalfAngle, nodeB.coneHalfAngle));
    }

    Body m_a;
    Body m_b;
    Settings m_settings;
    const TailTable& m_table = tailTable();
    std::vector<Entry> m_queue;
};

}  // namespace grapeshot::reference
