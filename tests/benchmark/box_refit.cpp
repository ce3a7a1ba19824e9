#include "box_refit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace grapeshot::bench {

namespace {

struct Box {
    Eigen::Vector3f low = Eigen::Vector3f::Constant(std::numeric_limits<float>::infinity());
    Eigen::Vector3f high = Eigen::Vector3f::Constant(-std::numeric_limits<float>::infinity());
};

Box boxOfLeaf(const Tree& tree, LeafBlock& leaf) {
    Box box;
    for (int lane = 0; lane < 4; ++lane) {
        const std::uint32_t triangle = leaf.triangle[lane] == noTriangle ? leaf.triangle[0] : leaf.triangle[lane];
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const Eigen::Vector3f& vertex = tree.vertices[tree.triangles[triangle][corner]];
            for (int axis = 0; axis < 3; ++axis) {
                leaf.corner[corner][axis][lane] = vertex[axis];
                box.low[axis] = std::min(box.low[axis], vertex[axis]);
                box.high[axis] = std::max(box.high[axis], vertex[axis]);
            }
        }
    }
    return box;
}

}  // namespace

void refitBoxes(Tree& tree, std::span<const Eigen::Vector3f> vertices) {
    std::copy(vertices.begin(), vertices.end(), tree.vertices.begin());
    std::vector<Box> boxes(tree.nodes.size());
    for (std::size_t i = tree.nodes.size(); i-- > 0;) {
        Node& node = tree.nodes[i];
        Box whole;
        for (int slot = 0; slot < 4; ++slot) {
            const ChildRef child = node.child[slot];
            if (child == noChild) {
                continue;
            }
            const Box box = isLeaf(child) ? boxOfLeaf(tree, tree.leaves[indexOf(child)]) : boxes[child];
            float reach = 0;
            for (int axis = 0; axis < 3; ++axis) {
                const float middle = 0.5F * (box.low[axis] + box.high[axis]);
                const float half = std::max(box.high[axis] - middle, middle - box.low[axis]) * 1.000001F + 1e-20F;
                node.center[axis][slot] = middle;
                node.half[axis][slot] = half;
                reach += std::abs(node.normal[axis][slot]) * half;
                whole.low[axis] = std::min(whole.low[axis], box.low[axis]);
                whole.high[axis] = std::max(whole.high[axis], box.high[axis]);
            }
            node.slabHigh[slot] = reach * 1.00001F;
            node.slabLow[slot] = -reach * 1.00001F;
        }
        boxes[i] = whole;
    }
    tree.lower = boxes[0].low;
    tree.upper = boxes[0].high;
    tree.radius = tree.lower.cwiseAbs().cwiseMax(tree.upper.cwiseAbs()).norm();
}

}  // namespace grapeshot::bench
