#include <algorithm>

#include <grapeshot/adb/reference/grid_cells.hpp>
#include <grapeshot/adb/reference/tree.hpp>

namespace grapeshot::reference {

namespace {

/// Calls visit(triangle) for all whose boxes touch the given one.
template <class Visit>
void trianglesTouching(const Hierarchy& hierarchy, std::span<const Box> tight, const Box& box, const Visit& visit) {
    std::vector<std::uint32_t> stack{0};
    while (!stack.empty()) {
        const std::uint32_t index = stack.back();
        stack.pop_back();
        const TreeNode& node = hierarchy.nodes[index];
        if (!tight[index].touches(box)) {
            continue;
        }
        if (!node.isLeaf()) {
            stack.push_back(node.left + 1);
            stack.push_back(node.left);
            continue;
        }
        for (std::uint32_t t = node.begin; t < node.end; ++t) {
            visit(hierarchy.triangles[t]);
        }
    }
}

}  // namespace

std::vector<CellCounts> countCells(const Hierarchy& hierarchy, std::span<const Box> boxes, int grid,
                                   std::span<const double> taus) {
    std::vector<CellCounts> result;
    for (const double tau : taus) {
        result.push_back({{grid, tau}, {}});
        requireUsable(result.back().settings);
        result.back().wellFilled.reserve(boxes.size());
    }
    std::vector<Box> tight;
    tight.reserve(hierarchy.nodes.size());
    for (const TreeNode& node : hierarchy.nodes) {
        tight.push_back(Box::around(cornersOf(hierarchy, node)));
    }
    for (const Box& box : boxes) {
        GridAreas areas(box, grid);
        trianglesTouching(hierarchy, tight, box, [&](const auto& triangle) { areas.add(triangle); });
        for (CellCounts& counts : result) {
            counts.wellFilled.push_back(areas.wellFilled(counts.settings.tau));
        }
    }
    return result;
}

}  // namespace grapeshot::reference
