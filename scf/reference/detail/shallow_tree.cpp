#include <grapeshot/scf/reference/detail/shallow_tree.hpp>

#include <algorithm>
#include <limits>
#include <numeric>

namespace grapeshot::scf::reference::detail {

namespace {

using Eigen::Vector3f;

constexpr float infinity = std::numeric_limits<float>::infinity();
const Bounds nothing{Vector3f::Constant(infinity), Vector3f::Constant(-infinity)};

void include(Bounds& bounds, const Vector3f& point) {
    bounds.lower = bounds.lower.cwiseMin(point);
    bounds.upper = bounds.upper.cwiseMax(point);
}

bool within(const Bounds& a, const Bounds& b, float reach) {
    return (a.lower.array() <= b.upper.array() + reach).all() && (b.lower.array() <= a.upper.array() + reach).all();
}

}  // namespace

ShallowTree buildShallowTree(std::span<const Vector3f> vertices, std::span<const Triangle> triangles, int depth) {
    ShallowTree tree;
    tree.order.resize(triangles.size());
    std::iota(tree.order.begin(), tree.order.end(), 0U);
    std::vector<Vector3f> middles;
    for (const Triangle& t : triangles) {
        middles.push_back((vertices[t[0]] + vertices[t[1]] + vertices[t[2]]) / 3);
    }
    tree.nodes.push_back({0, static_cast<std::uint32_t>(triangles.size()), 0});
    for (std::size_t n = 0; n < tree.nodes.size(); ++n) {
        const ShallowNode node = tree.nodes[n];
        if (node.depth == depth || node.count < 2) {
            continue;
        }
        const auto begin = tree.order.begin() + node.first;
        const auto end = begin + node.count;
        Bounds bounds = nothing;
        std::for_each(begin, end, [&](std::uint32_t t) { include(bounds, middles[t]); });
        int axis = 0;
        (bounds.upper - bounds.lower).maxCoeff(&axis);
        const std::uint32_t half = node.count / 2;
        std::nth_element(begin, begin + half, end, [&](std::uint32_t x, std::uint32_t y) {
            return middles[x][axis] != middles[y][axis] ? middles[x][axis] < middles[y][axis] : x < y;
        });
        tree.nodes[n].first = static_cast<std::uint32_t>(tree.nodes.size());
        tree.nodes[n].count = 0;
        tree.nodes.push_back({node.first, half, node.depth + 1});
        tree.nodes.push_back({node.first + half, node.count - half, node.depth + 1});
    }
    return tree;
}

std::vector<Bounds> fitted(const ShallowTree& tree, std::span<const Triangle> triangles,
                           std::span<const Vector3f> vertices) {
    std::vector<Bounds> boxes(tree.nodes.size(), nothing);
    for (std::size_t n = tree.nodes.size(); n-- > 0;) {
        const ShallowNode& node = tree.nodes[n];
        if (node.isLeaf()) {
            for (const std::uint32_t t : trianglesBelow(tree, static_cast<std::uint32_t>(n))) {
                for (const std::uint32_t vertex : triangles[t]) {
                    include(boxes[n], vertices[vertex]);
                }
            }
        } else {
            for (const std::uint32_t child : {node.first, node.first + 1}) {
                include(boxes[n], boxes[child].lower);
                include(boxes[n], boxes[child].upper);
            }
        }
    }
    return boxes;
}

std::vector<NodePair> overlappingNodes(const ShallowTree& a, std::span<const Bounds> boxesA, const ShallowTree& b,
                                       std::span<const Bounds> boxesB, int depth, float reach, std::size_t& tests) {
    std::vector<NodePair> found;
    std::vector<NodePair> open{{0, 0}};
    while (!open.empty()) {
        const auto [nodeA, nodeB] = open.back();
        open.pop_back();
        ++tests;
        if (!within(boxesA[nodeA], boxesB[nodeB], reach)) {
            continue;
        }
        const auto isEnd = [depth](const ShallowNode& node) { return node.isLeaf() || node.depth >= depth; };
        const bool endA = isEnd(a.nodes[nodeA]);
        const bool endB = isEnd(b.nodes[nodeB]);
        if (endA && endB) {
            found.emplace_back(nodeA, nodeB);
            continue;
        }
        for (std::uint32_t i = 0; i < (endA ? 1U : 2U); ++i) {
            for (std::uint32_t j = 0; j < (endB ? 1U : 2U); ++j) {
                open.emplace_back(endA ? nodeA : a.nodes[nodeA].first + i, endB ? nodeB : b.nodes[nodeB].first + j);
            }
        }
    }
    std::ranges::sort(found);
    return found;
}

std::span<const std::uint32_t> trianglesBelow(const ShallowTree& tree, std::uint32_t node) {
    std::uint32_t first = node;
    std::uint32_t last = node;
    while (!tree.nodes[first].isLeaf()) {
        first = tree.nodes[first].first;
    }
    while (!tree.nodes[last].isLeaf()) {
        last = tree.nodes[last].first + 1;
    }
    const std::uint32_t begin = tree.nodes[first].first;
    return {tree.order.data() + begin, tree.nodes[last].first + tree.nodes[last].count - begin};
}

}  // namespace grapeshot::scf::reference::detail
