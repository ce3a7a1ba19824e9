#include <grapeshot/scf/box_tree.hpp>

namespace grapeshot {

void BoxTree::reset(const BallTree& tree) {
    m_tree = &tree;
    m_boxes.resize(tree.leaves.size());
    m_leaves.assign(tree.leaves.size(), {});
    m_reach.assign(tree.leaves.size(), -1);
    m_nodes.resize(tree.nodes.size());
}

void BoxTree::set(std::uint32_t leaf, const Boxes<16>& boxes, const PlainBox& whole, float reach) {
    m_boxes[leaf] = boxes;
    m_leaves[leaf] = whole;
    m_reach[leaf] = reach;
}

void BoxTree::refit() {
    for (std::size_t i = m_nodes.size(); i-- > 0;) {
        const BallNode& node = m_tree->nodes[i];
        for (std::uint32_t slot = 0; slot < 4; ++slot) {
            PlainBox box;
            if (slot < node.count && isBallLeaf(node.child[slot])) {
                const std::uint32_t leaf = ballIndex(node.child[slot]);
                box = m_leaves[leaf];
                box.grow(m_reach[leaf]);
            } else if (slot < node.count) {
                for (int k = 0; k < 4; ++k) {
                    box.add(m_nodes[node.child[slot]].at(k));
                }
            }
            m_nodes[i].set(static_cast<int>(slot), box);
        }
    }
}

}  // namespace grapeshot
