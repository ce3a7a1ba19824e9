// This work is based on:
// Ingo Wald. On fast Construction of SAH-based Bounding Volume Hierarchies. 2007 (bins)
#include <grapeshot/adb/detail/binary_tree.hpp>

#include <algorithm>
#include <limits>

#include <grapeshot/core/detail/sliced_sort.hpp>

namespace grapeshot::detail {
namespace {

constexpr int maxBins = 64;
// Binned splits that peel off a triangle at a time could go as deep as there are triangles. From this level on groups
// are halved, so that the depth is at most this plus log2 of the number of triangles.
constexpr std::uint32_t maxBinnedLevel = 64;
/// Triangles of a group that is split in one piece.
constexpr std::uint32_t splitAtOnce = 96;

struct Box {
    float lower[3] = {std::numeric_limits<float>::infinity(), std::numeric_limits<float>::infinity(),
                      std::numeric_limits<float>::infinity()};
    float upper[3] = {-std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity(),
                      -std::numeric_limits<float>::infinity()};

    void grow(const Box& other) {
        for (int axis = 0; axis < 3; ++axis) {
            lower[axis] = std::min(lower[axis], other.lower[axis]);
            upper[axis] = std::max(upper[axis], other.upper[axis]);
        }
    }
    /// How likely a partner meets the box: the volume of its Minkowski sum with a cube of its own mean size, m^3. A few
    /// per cent fewer steps than with the surface, which is right for rays. In double: coordinates reach 1e15.
    [[nodiscard]] double reach() const {
        const double x = double{upper[0]} - lower[0];
        const double y = double{upper[1]} - lower[1];
        const double z = double{upper[2]} - lower[2];
        const double mean = (x + y + z) / 3;
        return x < 0 ? 0 : (x + mean) * (y + mean) * (z + mean);
    }
};

/// A triangle while it is being sorted.
struct Item {
    Box box;
    std::uint32_t triangle = 0;

    /// Twice the middle of the box: where a triangle counts as being.
    [[nodiscard]] float place(int axis) const { return box.lower[axis] + box.upper[axis]; }
};

struct Split {
    int axis = -1;
    int bin = 0;  ///< the first bin on the right side
    float low = 0;
    float scale = 0;  ///< bins per metre of place()
};

class Sorter {
  public:
    Sorter(const Tree& tree, const BuildSettings& settings, BinaryTree& out)
        : m_tree(tree), m_settings(settings), m_out(out) {}

    Sliced run() {
        const std::size_t count = m_out.order.size();
        m_items.reserve(count);
        const auto gather = [&](std::size_t begin, std::size_t end) { gatherItems(begin, end); };
        co_await inPieces(0, count, 8, gather);
        std::vector<std::uint32_t> tasks;
        for (std::size_t i = m_out.nodes.size(); i-- > 0;) {
            if (m_out.nodes[i].left == 0) {
                tasks.push_back(static_cast<std::uint32_t>(i));
            }
        }
        m_out.nodes.reserve(m_out.nodes.size() + 2 * count);
        while (!tasks.empty()) {
            const std::uint32_t node = tasks.back();
            tasks.pop_back();
            const BinaryNode group = m_out.nodes[node];
            if (group.size() <= static_cast<std::uint32_t>(m_settings.maxLeafTriangles)) {
                continue;
            }
            std::uint32_t middle = 0;
            if (group.size() <= splitAtOnce) {
                co_yield 2 + group.size() / 16;
                middle = splitInTwo({group.begin, group.end}, group.level);
            } else {
                co_await splitInSlices({group.begin, group.end}, group.level, middle);
            }
            const auto left = static_cast<std::uint32_t>(m_out.nodes.size());
            m_out.nodes[node].left = left;
            m_out.nodes[node].right = left + 1;
            m_out.nodes.push_back({group.begin, middle, 0, 0, 0, group.level + 1});
            m_out.nodes.push_back({middle, group.end, 0, 0, 0, group.level + 1});
            tasks.push_back(left + 1);
            tasks.push_back(left);
        }
        const auto take = [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                m_out.order[i] = m_items[i].triangle;
            }
        };
        co_await inPieces(0, count, 64, take);
        const std::size_t nodes = m_out.nodes.size();
        m_boxes.reserve(nodes);
        const auto clear = [&](std::size_t, std::size_t end) { m_boxes.resize(end); };
        co_await inPieces(0, nodes, 64, clear);
        const auto reach = [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                fillReach(nodes - 1 - i);
            }
        };
        co_await inPieces(0, nodes, 8, reach);
    }

  private:
    struct Range {
        std::uint32_t begin;
        std::uint32_t end;
        [[nodiscard]] std::uint32_t size() const { return end - begin; }
    };

    void gatherItems(std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            Item& item = m_items.emplace_back();
            item.triangle = m_out.order[i];
            for (const std::uint32_t corner : m_tree.triangles[item.triangle]) {
                Box point;
                for (int axis = 0; axis < 3; ++axis) {
                    point.lower[axis] = point.upper[axis] = m_tree.vertices[corner][axis];
                }
                item.box.grow(point);
            }
        }
    }

    /// Bottom-up: children stand after their parents.
    void fillReach(std::size_t i) {
        BinaryNode& node = m_out.nodes[i];
        if (node.left != 0) {
            m_boxes[i].grow(m_boxes[node.left]);
            m_boxes[i].grow(m_boxes[node.right]);
        } else {
            for (std::uint32_t item = node.begin; item < node.end; ++item) {
                m_boxes[i].grow(m_items[item].box);
            }
        }
        node.reach = m_boxes[i].reach();
    }

    /// Of the places of some triangles.
    struct Bounds {
        float low[3] = {std::numeric_limits<float>::infinity(), std::numeric_limits<float>::infinity(),
                        std::numeric_limits<float>::infinity()};
        float high[3] = {-std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity(),
                         -std::numeric_limits<float>::infinity()};

        [[nodiscard]] int longestAxis() const {
            int axis = 0;
            for (int other = 1; other < 3; ++other) {
                if (high[other] - low[other] > high[axis] - low[axis]) {
                    axis = other;
                }
            }
            return axis;
        }
    };
    /// What of a group is in the bins of one axis.
    struct Bins {
        Box boxes[maxBins];
        std::size_t counts[maxBins] = {};
    };
    /// A partition on its way: what is before `first` goes left, what is from `last` on goes right.
    struct Partition {
        std::size_t first, last;
        bool isStuck = false;  ///< `first` goes right; somebody to swap it with is looked for
    };

    void growBounds(Bounds& bounds, std::size_t begin, std::size_t end) const {
        for (std::size_t i = begin; i < end; ++i) {
            for (int axis = 0; axis < 3; ++axis) {
                bounds.low[axis] = std::min(bounds.low[axis], m_items[i].place(axis));
                bounds.high[axis] = std::max(bounds.high[axis], m_items[i].place(axis));
            }
        }
    }

    /// Up to so many looks at triangles.
    void goOn(Partition& partition, const Split& split, std::size_t looks) {
        const auto goesLeft = [&](const Item& item) {
            return binOf(item.place(split.axis), split.low, split.scale) < split.bin;
        };
        for (; looks > 0 && partition.first != partition.last; --looks) {
            if (!partition.isStuck) {
                if (goesLeft(m_items[partition.first])) {
                    ++partition.first;
                } else {
                    partition.isStuck = true;
                    --partition.last;
                }
            } else if (goesLeft(m_items[partition.last])) {
                std::swap(m_items[partition.first], m_items[partition.last]);
                ++partition.first;
                partition.isStuck = false;
            } else {
                --partition.last;
            }
        }
    }

    /// Where the right part begins; both parts have at least one triangle.
    std::uint32_t splitInTwo(const Range& range, std::uint32_t level) {
        Bounds bounds;
        growBounds(bounds, range.begin, range.end);
        Split split;
        if (level < maxBinnedLevel) {
            double cost = std::numeric_limits<double>::infinity();
            for (int axis = 0; axis < 3; ++axis) {
                const float scale = scaleOf(bounds, axis);
                if (scale > 0) {
                    Bins bins;
                    count(bins, axis, bounds.low[axis], scale, range.begin, range.end);
                    weigh(bins, {axis, 0, bounds.low[axis], scale}, range.size(), split, cost);
                }
            }
        }
        if (split.axis < 0) {
            const int axis = bounds.longestAxis();
            if (bounds.high[axis] > bounds.low[axis]) {
                std::sort(m_items.begin() + static_cast<std::ptrdiff_t>(range.begin),
                          m_items.begin() + static_cast<std::ptrdiff_t>(range.end), ByPlace{axis});
            }
            return range.begin + range.size() / 2;
        }
        Partition partition{range.begin, range.end};
        goOn(partition, split, 2 * range.size());
        return static_cast<std::uint32_t>(partition.first);
    }

    /// The same for a large group.
    Sliced splitInSlices(Range range, std::uint32_t level, std::uint32_t& middle) {
        Bounds bounds;
        const auto grow = [&](std::size_t begin, std::size_t end) { growBounds(bounds, begin, end); };
        co_await inPieces(range.begin, range.end, 64, grow);
        Split split;
        if (level < maxBinnedLevel) {
            double cost = std::numeric_limits<double>::infinity();
            for (int axis = 0; axis < 3; ++axis) {
                const float scale = scaleOf(bounds, axis);
                if (scale > 0) {
                    Bins bins;
                    const auto countSome = [&](std::size_t begin, std::size_t end) {
                        count(bins, axis, bounds.low[axis], scale, begin, end);
                    };
                    co_await inPieces(range.begin, range.end, 48, countSome);
                    weigh(bins, {axis, 0, bounds.low[axis], scale}, range.size(), split, cost);
                }
            }
        }
        if (split.axis < 0) {
            // By rank along the longest axis; by triangle index where all are at one place.
            const int axis = bounds.longestAxis();
            if (bounds.high[axis] > bounds.low[axis]) {
                co_await sortSliced(m_items, range.begin, range.end, m_spare, ByPlace{axis});
            }
            middle = range.begin + range.size() / 2;
            co_return;
        }
        Partition partition{range.begin, range.end};
        constexpr std::size_t perUnit = 32;
        while (partition.first != partition.last) {
            co_yield mostSlicedPiece;
            goOn(partition, split, mostSlicedPiece * perUnit);
        }
        middle = static_cast<std::uint32_t>(partition.first);
    }

    struct ByPlace {
        int axis;
        bool operator()(const Item& a, const Item& b) const {
            return a.place(axis) != b.place(axis) ? a.place(axis) < b.place(axis) : a.triangle < b.triangle;
        }
    };

    /// Bins per metre; 0: no extent, or so little that its inverse overflows.
    [[nodiscard]] float scaleOf(const Bounds& bounds, int axis) const {
        const float scale = static_cast<float>(m_settings.bins) / (bounds.high[axis] - bounds.low[axis]);
        return scale < std::numeric_limits<float>::max() ? scale : 0;
    }

    [[nodiscard]] int binOf(float place, float low, float scale) const {
        return std::min(static_cast<int>((place - low) * scale), m_settings.bins - 1);
    }

    void count(Bins& bins, int axis, float low, float scale, std::size_t begin, std::size_t end) const {
        for (std::size_t i = begin; i < end; ++i) {
            const int bin = binOf(m_items[i].place(axis), low, scale);
            bins.boxes[bin].grow(m_items[i].box);
            ++bins.counts[bin];
        }
    }

    /// The cheapest split by reach times number of leaves on either side; `best` stays as it is if none is cheaper.
    void weigh(const Bins& bins, Split candidate, std::size_t size, Split& best, double& bestCost) const {
        double rightCost[maxBins];
        Box box;
        std::size_t number = 0;
        for (int bin = m_settings.bins - 1; bin > 0; --bin) {
            box.grow(bins.boxes[bin]);
            number += bins.counts[bin];
            rightCost[bin] = cost(box, number);
        }
        box = Box();
        number = 0;
        for (int bin = 1; bin < m_settings.bins; ++bin) {
            box.grow(bins.boxes[bin - 1]);
            number += bins.counts[bin - 1];
            const double total = cost(box, number) + rightCost[bin];
            if (number > 0 && number < size && total < bestCost) {
                bestCost = total;
                candidate.bin = bin;
                best = candidate;
            }
        }
    }

    /// Leaves are tested four triangles at a time, so a part-filled one costs as much as a full one.
    [[nodiscard]] double cost(const Box& box, std::size_t count) const {
        const auto leaf = static_cast<std::size_t>(m_settings.maxLeafTriangles);
        const std::size_t leaves = (count + leaf - 1) / leaf;
        return box.reach() * static_cast<double>(leaves);
    }

    const Tree& m_tree;
    const BuildSettings& m_settings;
    BinaryTree& m_out;
    std::vector<Item> m_items;
    std::vector<Item> m_spare;
    std::vector<Box> m_boxes;
};

}  // namespace

Sliced splitLeavesInSlices(const Tree& tree, const BuildSettings& settings, BinaryTree& binary) {
    Sorter sorter(tree, settings, binary);
    co_await sorter.run();
}

void splitLeaves(const Tree& tree, const BuildSettings& settings, BinaryTree& binary) {
    splitLeavesInSlices(tree, settings, binary).run();
}

Sliced sortInTwosInSlices(const Tree& tree, const BuildSettings& settings, BinaryTree& all) {
    const std::size_t count = tree.triangles.size();
    all = {};
    all.order.reserve(count);
    const auto number = [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            all.order.push_back(static_cast<std::uint32_t>(i));
        }
    };
    co_await inPieces(0, count, 512, number);
    all.nodes.push_back({0, static_cast<std::uint32_t>(count), 0, 0, 0, 0});
    co_await splitLeavesInSlices(tree, settings, all);
}

}  // namespace grapeshot::detail
