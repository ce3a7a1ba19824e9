// The traversal without estimates, on the same trees: what the paper's speed-up is measured against.
//
// This work is based on:
// Gabriel Zachmann. Rapid Collision Detection by Dynamically Aligned DOP-Trees. VRAIS 1998 (with Dop)
// Gabriel Zachmann. Minimal Hierarchical Collision Detection. VRST 2002 (with Box)
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <grapeshot/adb/reference/leaf_test.hpp>
#include <grapeshot/adb/reference/tree.hpp>

namespace grapeshot::reference {

struct ExactAnswer {
    bool collides = false;
    bool rootsOverlap = false;
    std::size_t volumeTests = 0;
    std::size_t triangleTests = 0;
};

/// Keeps references to both trees. Depth first, the last child pair first, the end at the first intersecting pair of
/// triangles.
template <BoundingVolume V>
class ExactQuery {
  public:
    ExactQuery(const BoundedTree<V>& a, const BoundedTree<V>& b) : m_a(a), m_b(b) {}

    /// @throws Error notFinite, notRigid
    [[nodiscard]] ExactAnswer decide(const Pose& bInA) {
        const Placement placement(bInA);
        const typename V::PairTest test(placement);
        ExactAnswer answer{.volumeTests = 1};
        answer.rootsOverlap = !test.disjoint(m_a.volumes[0], m_b.volumes[0]);
        m_stack.clear();
        if (answer.rootsOverlap) {
            m_stack.emplace_back(0, 0);
        }
        while (!m_stack.empty()) {
            const auto [indexA, indexB] = m_stack.back();
            m_stack.pop_back();
            const TreeNode& nodeA = m_a.hierarchy.nodes[indexA];
            const TreeNode& nodeB = m_b.hierarchy.nodes[indexB];
            if (nodeA.isLeaf() && nodeB.isLeaf()) {
                if (leavesOverlap(m_a.hierarchy, nodeA, m_b.hierarchy, nodeB, placement, answer.triangleTests)) {
                    answer.collides = true;
                    return answer;
                }
                continue;
            }
            const std::uint32_t firstA = nodeA.isLeaf() ? indexA : nodeA.left;
            const std::uint32_t lastA = nodeA.isLeaf() ? indexA : nodeA.left + 1;
            const std::uint32_t firstB = nodeB.isLeaf() ? indexB : nodeB.left;
            const std::uint32_t lastB = nodeB.isLeaf() ? indexB : nodeB.left + 1;
            for (std::uint32_t childA = firstA; childA <= lastA; ++childA) {
                for (std::uint32_t childB = firstB; childB <= lastB; ++childB) {
                    ++answer.volumeTests;
                    if (!test.disjoint(m_a.volumes[childA], m_b.volumes[childB])) {
                        m_stack.emplace_back(childA, childB);
                    }
                }
            }
        }
        return answer;
    }

  private:
    const BoundedTree<V>& m_a;
    const BoundedTree<V>& m_b;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> m_stack;
};

}  // namespace grapeshot::reference
