#include <grapeshot/adb/augment.hpp>

#include <algorithm>

#include <grapeshot/adb/detail/binary_tree.hpp>
#include <grapeshot/adb/detail/wide_tree.hpp>
#include <grapeshot/adb/tuning.hpp>
#include <grapeshot/core/error.hpp>

namespace grapeshot {
namespace {

constexpr std::uint32_t leafTriangles = 4;
// Splits as bad as one to two, which is what Bullet's builders allow at worst, bring 2^28 triangles down to one in 48
// levels. What is deeper is a chain: its lower end is split anew, which keeps trees within the 64 + 28 levels that
// detail::NodeStack is made for, and slabs from costing the square of the number of triangles.
constexpr std::uint32_t deepestKept = 48;

std::string placeOf(std::uint32_t node) {
    return "node " + std::to_string(node) + " of the hierarchy";
}

/// Checks a foreign hierarchy and brings it into the order of a BinaryTree.
class Reader {
  public:
    Reader(const ForeignHierarchy& hierarchy, std::size_t triangles)
        : m_hierarchy(hierarchy), m_reached(hierarchy.nodes.size()), m_inLeaf(triangles) {}

    detail::BinaryTree run() {
        visitAll();
        const auto missing = std::find(m_inLeaf.begin(), m_inLeaf.end(), false);
        if (missing != m_inLeaf.end()) {
            throw Error(Fault::badHierarchy,
                        "triangle " + std::to_string(missing - m_inLeaf.begin()) + " is in no leaf", "hierarchy");
        }
        closeGroups();
        return pruned();
    }

  private:
    /// A node, at the place where a walk from the root, left before right, meets it.
    struct Group {
        std::uint32_t begin = 0;  ///< its triangles in m_order
        std::uint32_t end = 0;
        std::uint32_t right = 0;  ///< group; the left one stands next to this; 0 for a leaf
        std::uint32_t after = 0;  ///< the first group that is not below this one
        std::uint32_t level = 0;
        [[nodiscard]] bool isCut() const { return right == 0 || end - begin <= leafTriangles || level >= deepestKept; }
    };

    void visitAll() {
        struct Task {
            std::uint32_t node;
            std::uint32_t parent;  ///< group
        };
        if (m_hierarchy.nodes.empty()) {
            throw Error(Fault::badHierarchy, "no nodes", "hierarchy");
        }
        std::vector<Task> tasks = {{0, 0}};
        m_reached[0] = true;
        while (!tasks.empty()) {
            const auto [index, parent] = tasks.back();
            tasks.pop_back();
            const ForeignNode& node = m_hierarchy.nodes[index];
            const auto self = static_cast<std::uint32_t>(m_groups.size());
            Group& group = m_groups.emplace_back();
            group.begin = static_cast<std::uint32_t>(m_order.size());
            if (self > 0) {
                group.level = m_groups[parent].level + 1;
                if (self != parent + 1) {
                    m_groups[parent].right = self;
                }
            }
            if (node.left == 0 && node.right == 0) {
                takeLeaf(node, index);
                group.end = static_cast<std::uint32_t>(m_order.size());
                continue;
            }
            for (const std::uint32_t child : {node.right, node.left}) {
                reach(child, index);
                tasks.push_back({child, self});
            }
        }
    }

    void reach(std::uint32_t child, std::uint32_t parent) {
        if (child >= m_hierarchy.nodes.size()) {
            throw Error(Fault::indexOutOfRange,
                        "node " + std::to_string(child) + " of " + std::to_string(m_hierarchy.nodes.size()),
                        placeOf(parent));
        }
        if (m_reached[child]) {
            throw Error(Fault::badHierarchy, "node " + std::to_string(child) + " is reached a second time",
                        placeOf(parent));
        }
        m_reached[child] = true;
    }

    void takeLeaf(const ForeignNode& leaf, std::uint32_t index) {
        if (leaf.end > m_hierarchy.triangles.size() || leaf.begin > leaf.end) {
            throw Error(Fault::indexOutOfRange,
                        "range " + std::to_string(leaf.begin) + " to " + std::to_string(leaf.end) + " of " +
                            std::to_string(m_hierarchy.triangles.size()),
                        placeOf(index));
        }
        if (leaf.begin == leaf.end) {
            throw Error(Fault::badHierarchy, "a leaf without triangles", placeOf(index));
        }
        for (std::uint32_t i = leaf.begin; i < leaf.end; ++i) {
            const std::uint32_t triangle = m_hierarchy.triangles[i];
            if (triangle >= m_inLeaf.size()) {
                throw Error(Fault::indexOutOfRange,
                            "triangle " + std::to_string(triangle) + " of " + std::to_string(m_inLeaf.size()),
                            placeOf(index));
            }
            if (m_inLeaf[triangle]) {
                throw Error(Fault::badHierarchy, "triangle " + std::to_string(triangle) + " is met a second time",
                            placeOf(index));
            }
            m_inLeaf[triangle] = true;
            m_order.push_back(triangle);
        }
    }

    void closeGroups() {
        for (std::size_t i = m_groups.size(); i-- > 0;) {
            Group& group = m_groups[i];
            group.after = group.right == 0 ? static_cast<std::uint32_t>(i + 1) : m_groups[group.right].after;
            group.end = group.right == 0 ? group.end : m_groups[group.right].end;
        }
    }

    /// Without what is below groups that become leaves, or are split anew.
    detail::BinaryTree pruned() {
        detail::BinaryTree out;
        std::vector<std::uint32_t> kept;  // group of each node
        std::vector<std::uint32_t> nodeOf(m_groups.size());
        for (std::uint32_t i = 0; i < m_groups.size(); i = m_groups[i].isCut() ? m_groups[i].after : i + 1) {
            nodeOf[i] = static_cast<std::uint32_t>(kept.size());
            kept.push_back(i);
        }
        for (std::uint32_t node = 0; node < kept.size(); ++node) {
            const Group& group = m_groups[kept[node]];
            const bool isCut = group.isCut();
            out.nodes.push_back(
                {group.begin, group.end, isCut ? 0 : node + 1, isCut ? 0 : nodeOf[group.right], 0, group.level});
        }
        out.order = std::move(m_order);
        return out;
    }

    const ForeignHierarchy& m_hierarchy;
    std::vector<bool> m_reached;  // node
    std::vector<bool> m_inLeaf;   // triangle
    std::vector<Group> m_groups;
    std::vector<std::uint32_t> m_order;  // triangles
};

}  // namespace

Tree augment(MeshView mesh, const ForeignHierarchy& hierarchy) {
    Tree tree = detail::treeWithoutNodes(mesh);
    detail::BinaryTree binary = Reader(hierarchy, mesh.triangles.size()).run();
    detail::splitLeaves(tree, {.maxLeafTriangles = static_cast<int>(leafTriangles)}, binary);
    detail::addNodes(binary, tree);
    tune(tree, BuildSettings().tuningPoses);
    return tree;
}

}  // namespace grapeshot
