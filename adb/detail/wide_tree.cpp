// This work is based on:
// Henri Ylitie, Tero Karras, Samuli Laine. Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs.
// HPG 2017 (section 3: the cheapest wide tree out of a binary one)
#include <grapeshot/adb/detail/wide_tree.hpp>

#include <algorithm>

#include <grapeshot/adb/detail/tree_contents.hpp>
#include <grapeshot/core/error.hpp>
#include <grapeshot/core/mesh_slices.hpp>

namespace grapeshot::detail {
namespace {

// Four times the node index plus the slot and the leaf bit must fit into 32 bits (see detail/descent.hpp).
constexpr std::size_t maxTriangles = std::size_t{1} << 28U;

/// Makes a four-wide tree out of a binary one so that the sum over all nodes and leaves of how likely they are met is
/// the least.
class Widener {
  public:
    Widener(const BinaryTree& binary, Tree& tree) : m_binary(binary), m_tree(tree) {}

    Sliced run() {
        const std::size_t count = m_binary.nodes.size();
        m_plans.reserve(count);
        const auto clear = [&](std::size_t, std::size_t end) { m_plans.resize(end); };
        co_await inPieces(0, count, 16, clear);
        std::size_t leaves = 0;
        const auto plan = [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                const std::size_t fromTheBack = count - 1 - i;
                m_plans[fromTheBack] = planFor(m_binary.nodes[fromTheBack]);
                leaves += m_binary.nodes[fromTheBack].left == 0 ? 1U : 0U;
            }
        };
        co_await inPieces(0, count, 4, plan);
        m_tree.leaves.reserve(leaves);
        m_nodes.reserve(leaves);  // as many at most
        m_tasks = {{0, 0}};
        m_nodes.emplace_back();
        while (!m_tasks.empty()) {
            co_yield mostSlicedPiece;
            for (std::size_t i = 0; i < mostSlicedPiece && !m_tasks.empty(); ++i) {
                makeNode();
            }
        }
        m_tree.nodes.clear();
        m_tree.nodes.reserve(m_nodes.size());
        const auto copy = [&](std::size_t begin, std::size_t end) {
            m_tree.nodes.insert(m_tree.nodes.end(), m_nodes.begin() + static_cast<std::ptrdiff_t>(begin),
                                m_nodes.begin() + static_cast<std::ptrdiff_t>(end));
        };
        co_await inPieces(0, m_nodes.size(), 4, copy);
    }

  private:
    /// How a group is best spread over the slots of a node.
    struct Plan {
        double cost[5] = {};        ///< [slots]: of taking at most 1..4 slots of the node above
        std::uint8_t left[5] = {};  ///< [slots]: how many of them the left half gets
        bool whole[5] = {};         ///< [slots]: cheaper to take one slot, as a node of its own
    };

    struct Task {
        std::uint32_t node;
        std::uint32_t group;
    };

    void makeNode() {
        const Task task = m_tasks.back();
        m_tasks.pop_back();
        std::uint32_t parts[4];
        int count = 0;
        if (m_binary.nodes[task.group].left == 0) {
            parts[count++] = task.group;  // the root of a mesh of one leaf
        } else {
            collect(task.group, 4, parts, count);
        }
        // Siblings stand side by side, and a subtree's leaves are consecutive: the last pushed is done first.
        const std::size_t pushed = m_tasks.size();
        for (int slot = 0; slot < 4; ++slot) {
            ChildRef child = noChild;
            if (slot < count && m_binary.nodes[parts[slot]].left == 0) {
                child = leafBit | makeLeaf(m_binary.nodes[parts[slot]]);
            } else if (slot < count) {
                child = static_cast<ChildRef>(m_nodes.size());
                m_nodes.emplace_back();
                m_tasks.push_back({child, parts[slot]});
            }
            m_nodes[task.node].child[slot] = child;
        }
        std::reverse(m_tasks.begin() + static_cast<std::ptrdiff_t>(pushed), m_tasks.end());
    }

    [[nodiscard]] Plan planFor(const BinaryNode& group) const {
        Plan plan;
        if (group.left == 0) {
            std::fill(plan.cost, plan.cost + 5, group.reach);
            return plan;
        }
        for (std::uint8_t slots = 2; slots <= 4; ++slots) {
            for (std::uint8_t left = 1; left < slots; ++left) {
                const double cost = m_plans[group.left].cost[left] + m_plans[group.right].cost[slots - left];
                if (left == 1 || cost < plan.cost[slots]) {
                    plan.cost[slots] = cost;
                    plan.left[slots] = left;
                }
            }
        }
        plan.cost[1] = group.reach + plan.cost[4];
        plan.whole[1] = true;
        for (std::uint8_t slots = 2; slots <= 4; ++slots) {
            plan.whole[slots] = plan.cost[1] < plan.cost[slots];
            plan.cost[slots] = std::min(plan.cost[1], plan.cost[slots]);
        }
        return plan;
    }

    /// The groups that fill `slots` slots with what is in `group`. At most three calls deep.
    void collect(std::uint32_t group, std::uint8_t slots, std::uint32_t (&parts)[4], int& count) const {
        const BinaryNode& node = m_binary.nodes[group];
        const std::uint8_t left = m_plans[group].left[slots];
        for (const auto& [half, share] :
             {std::pair(node.left, left), std::pair(node.right, std::uint8_t(slots - left))}) {
            if (m_binary.nodes[half].left == 0 || m_plans[half].whole[share]) {
                parts[count++] = half;
            } else {
                collect(half, share, parts, count);
            }
        }
    }

    std::uint32_t makeLeaf(const BinaryNode& group) {
        LeafBlock& leaf = m_tree.leaves.emplace_back();
        std::fill(leaf.triangle, leaf.triangle + 4, noTriangle);
        std::copy(m_binary.order.begin() + group.begin, m_binary.order.begin() + group.end, leaf.triangle);
        std::sort(leaf.triangle, leaf.triangle + group.size());
        return static_cast<std::uint32_t>(m_tree.leaves.size() - 1);
    }

    const BinaryTree& m_binary;
    std::vector<Plan> m_plans;
    std::vector<Task> m_tasks;
    std::vector<Node> m_nodes;
    Tree& m_tree;
};

}  // namespace

Sliced copyMeshInSlices(MeshView mesh, Tree& tree) {
    co_await requireUsableInSlices(mesh);
    if (mesh.triangles.size() > maxTriangles) {
        throw Error(Fault::tooLarge, std::to_string(mesh.triangles.size()) + " triangles, more than 2^28", "mesh");
    }
    const auto copy = [](auto from, auto& to, std::size_t begin, std::size_t end) {
        to.insert(to.end(), from.begin() + static_cast<std::ptrdiff_t>(begin),
                  from.begin() + static_cast<std::ptrdiff_t>(end));
    };
    tree.vertices.reserve(mesh.vertices.size());
    const auto copyVertices = [&](std::size_t begin, std::size_t end) {
        copy(mesh.vertices, tree.vertices, begin, end);
    };
    co_await inPieces(0, mesh.vertices.size(), 128, copyVertices);
    tree.triangles.reserve(mesh.triangles.size());
    const auto copyTriangles = [&](std::size_t begin, std::size_t end) {
        copy(mesh.triangles, tree.triangles, begin, end);
    };
    co_await inPieces(0, mesh.triangles.size(), 128, copyTriangles);
}

Tree treeWithoutNodes(MeshView mesh) {
    Tree tree;
    copyMeshInSlices(mesh, tree).run();
    return tree;
}

Sliced addNodesInSlices(const BinaryTree& binary, Tree& tree) {
    {
        Widener widener(binary, tree);
        co_await widener.run();
    }
    co_await fillContentsInSlices(tree);
}

void addNodes(const BinaryTree& binary, Tree& tree) {
    addNodesInSlices(binary, tree).run();
}

}  // namespace grapeshot::detail
