#include <grapeshot/adb/detail/tree_contents.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

#include <grapeshot/adb/detail/leaf_corners.hpp>
#include <grapeshot/adb/detail/surface_moments.hpp>

namespace grapeshot::detail {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

/// The nearest float that is not smaller / not larger.
float roundedUp(double value) {
    const auto narrow = static_cast<float>(value);
    return double{narrow} >= value ? narrow : std::nextafter(narrow, infinity);
}
float roundedDown(double value) {
    return -roundedUp(-value);
}

void fillLeaf(const Tree& tree, LeafBlock& leaf) {
    for (int lane = 0; lane < 4; ++lane) {
        const std::uint32_t triangle = leaf.triangle[lane] == noTriangle ? leaf.triangle[0] : leaf.triangle[lane];
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const Eigen::Vector3f& vertex = tree.vertices[tree.triangles[triangle][corner]];
            for (int axis = 0; axis < 3; ++axis) {
                leaf.corner[corner][axis][lane] = vertex[axis];
            }
        }
    }
}

SurfaceMoments leafMoments(const LeafBlock& leaf) {
    SurfaceMoments pieces[4];
    int count = 0;
    while (count < 4 && leaf.triangle[count] != noTriangle) {
        pieces[count] = momentsOf(cornerOf(leaf, 0, count), cornerOf(leaf, 1, count), cornerOf(leaf, 2, count));
        ++count;
    }
    return sum(pieces, count);
}

struct Extent {
    float lower[3] = {infinity, infinity, infinity};
    float upper[3] = {-infinity, -infinity, -infinity};

    void grow(const Extent& other) {
        for (int axis = 0; axis < 3; ++axis) {
            lower[axis] = std::min(lower[axis], other.lower[axis]);
            upper[axis] = std::max(upper[axis], other.upper[axis]);
        }
    }
};

Extent extentOf(const LeafBlock& leaf) {
    Extent out;
    for (int axis = 0; axis < 3; ++axis) {
        for (const auto& corner : leaf.corner) {
            for (const float x : corner[axis]) {
                out.lower[axis] = std::min(out.lower[axis], x);
                out.upper[axis] = std::max(out.upper[axis], x);
            }
        }
    }
    return out;
}

/// Denormal operands make the kernels ten times slower: whatever is so small that nobody sees it becomes zero.
float flushed(double value) {
    return std::abs(value) < 1e-20 ? 0.0F : static_cast<float>(value);
}

/// @param least half extents and slabs are not thinner, m: for the same reason, and far below the kernel's own slack.
void storeBox(const Extent& extent, double least, Node& node, int slot) {
    for (int axis = 0; axis < 3; ++axis) {
        const double low = extent.lower[axis];
        const double high = extent.upper[axis];
        const float middle = flushed(0.5 * (low + high));
        node.center[axis][slot] = middle;
        // A float minus a float is rounded in double by less than the step up makes good.
        const double half = std::max({high - double{middle}, double{middle} - low, least});
        node.half[axis][slot] = std::nextafter(roundedUp(half), infinity);
    }
}

/// The direction in which the surface is thin: its mean normal; where that cancels, the box's shortest axis.
Eigen::Vector3f slabNormal(const SurfaceMoments& moments, const Extent& extent) {
    const double length = moments.normalSum.norm();
    if (length > 1e-6 * moments.area) {
        return (moments.normalSum / length).unaryExpr(&flushed);
    }
    int axis = 0;
    for (int other = 1; other < 3; ++other) {
        if (extent.upper[other] - extent.lower[other] < extent.upper[axis] - extent.lower[axis]) {
            axis = other;
        }
    }
    return Eigen::Vector3f::Unit(axis);
}

/// Between which heights along a normal the corners of some leaves are. Four corners at a time, in double: its rounding
/// is far below the step outwards at the end.
struct Slab {
    double center[3];
    double normal[3];
    double low[4], high[4];

    Slab(const Node& node, int slot, const Eigen::Vector3f& direction) {
        for (int axis = 0; axis < 3; ++axis) {
            center[axis] = node.center[axis][slot];
            normal[axis] = direction[axis];
        }
        std::fill(low, low + 4, std::numeric_limits<double>::infinity());
        std::fill(high, high + 4, -std::numeric_limits<double>::infinity());
    }

    void grow(const Tree& tree, std::size_t begin, std::size_t end) {
        const double cx = center[0];
        const double cy = center[1];
        const double cz = center[2];
        const double x = normal[0];
        const double y = normal[1];
        const double z = normal[2];
        for (std::size_t i = begin; i < end; ++i) {
            for (const auto& corner : tree.leaves[i].corner) {
                for (int lane = 0; lane < 4; ++lane) {
                    const double height =
                        x * (corner[0][lane] - cx) + y * (corner[1][lane] - cy) + z * (corner[2][lane] - cz);
                    low[lane] = height < low[lane] ? height : low[lane];
                    high[lane] = height > high[lane] ? height : high[lane];
                }
            }
        }
    }

    void store(double least, Node& node, int slot) const {
        for (int axis = 0; axis < 3; ++axis) {
            node.normal[axis][slot] = static_cast<float>(normal[axis]);
        }
        const double lowest = *std::min_element(low, low + 4);
        const double highest = *std::max_element(high, high + 4);
        node.slabLow[slot] = std::nextafter(roundedDown(lowest - least), -infinity);
        node.slabHigh[slot] = std::nextafter(roundedUp(highest + least), infinity);
    }
};

void storeEmpty(Node& node, NodeDistribution& distribution, int slot) {
    for (int axis = 0; axis < 3; ++axis) {
        node.center[axis][slot] = 0;
        node.half[axis][slot] = emptyHalf;
        node.normal[axis][slot] = axis == 0 ? 1.0F : 0.0F;
    }
    node.slabLow[slot] = 0;
    node.slabHigh[slot] = 0;
    storeNone(slot, distribution);
}

}  // namespace

namespace {

LeafRange rangeOf(const Node& node, const std::vector<LeafRange>& ranges) {
    LeafRange range{std::numeric_limits<std::uint32_t>::max(), 0};
    for (const ChildRef child : node.child) {
        if (child == noChild) {
            continue;
        }
        const LeafRange part = isLeaf(child) ? LeafRange{indexOf(child), indexOf(child) + 1} : ranges[indexOf(child)];
        range = {std::min(range.begin, part.begin), std::max(range.end, part.end)};
    }
    return range;
}

}  // namespace

std::vector<LeafRange> leafRanges(const Tree& tree) {
    std::vector<LeafRange> ranges(tree.nodes.size());
    for (std::size_t i = tree.nodes.size(); i-- > 0;) {
        ranges[i] = rangeOf(tree.nodes[i], ranges);
    }
    return ranges;
}

Sliced fillContentsInSlices(Tree& tree) {
    double squaredRadius = 0;
    const auto fill = [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            LeafBlock& leaf = tree.leaves[i];
            fillLeaf(tree, leaf);
            for (int corner = 0; corner < 3; ++corner) {
                for (int lane = 0; lane < 4; ++lane) {
                    squaredRadius = std::max(squaredRadius, cornerOf(leaf, corner, lane).squaredNorm());
                }
            }
        }
    };
    co_await inPieces(0, tree.leaves.size(), 2, fill);
    tree.radius = std::nextafter(roundedUp(std::sqrt(squaredRadius)), infinity);
    const double least = double{tree.radius} * 0x1p-24;
    // From here on from the back: children stand after their parents.
    const std::size_t count = tree.nodes.size();
    std::vector<LeafRange> ranges;
    std::vector<SurfaceMoments> nodeMoments;
    std::vector<Extent> nodeExtents;
    ranges.reserve(count);
    nodeMoments.reserve(count);
    nodeExtents.reserve(count);
    tree.distributions.reserve(count);
    const auto clear = [&](std::size_t, std::size_t end) {
        ranges.resize(end);
        nodeMoments.resize(end);
        nodeExtents.resize(end);
        tree.distributions.resize(std::max(end, tree.distributions.size()));
    };
    co_await inPieces(0, count, 6, clear);
    const auto findRanges = [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            ranges[count - 1 - i] = rangeOf(tree.nodes[count - 1 - i], ranges);
        }
    };
    co_await inPieces(0, count, 16, findRanges);
    for (std::size_t i = count; i-- > 0;) {
        co_yield 6;
        Node& node = tree.nodes[i];
        SurfaceMoments parts[4];
        int number = 0;
        for (int slot = 0; slot < 4; ++slot) {
            const ChildRef child = node.child[slot];
            if (child == noChild) {
                storeEmpty(node, tree.distributions[i], slot);
                continue;
            }
            const std::uint32_t below = indexOf(child);
            const SurfaceMoments part = isLeaf(child) ? leafMoments(tree.leaves[below]) : nodeMoments[below];
            const Extent extent = isLeaf(child) ? extentOf(tree.leaves[below]) : nodeExtents[below];
            const LeafRange range = isLeaf(child) ? LeafRange{below, below + 1} : ranges[below];
            storeBox(extent, least, node, slot);
            Slab slab(node, slot, slabNormal(part, extent));
            if (range.end - range.begin <= 4) {
                slab.grow(tree, range.begin, range.end);
            } else {
                const auto grow = [&](std::size_t begin, std::size_t end) { slab.grow(tree, begin, end); };
                co_await inPieces(range.begin, range.end, 16, grow);
            }
            slab.store(least, node, slot);
            store(part, node, slot, tree.distributions[i]);
            nodeExtents[i].grow(extent);
            parts[number++] = part;
        }
        nodeMoments[i] = sum(parts, number);
    }
    for (int axis = 0; axis < 3; ++axis) {
        tree.lower[axis] = nodeExtents[0].lower[axis];
        tree.upper[axis] = nodeExtents[0].upper[axis];
    }
    storeWhole(nodeMoments[0], 0.5 * (tree.upper.cast<double>() - tree.lower.cast<double>()).norm(), tree.whole);
}

void fillContents(Tree& tree) {
    fillContentsInSlices(tree).run();
}

}  // namespace grapeshot::detail
