// This work is based on:
// Ingo Wald. On fast Construction of SAH-based Bounding Volume Hierarchies. 2007 (bins)
#include <grapeshot/adb/detail/binary_tree.hpp>

#include <algorithm>
#include <limits>
#include <numeric>

namespace grapeshot::detail {
namespace {

constexpr int maxBins = 64;
// Binned splits that peel off a triangle at a time could go as deep as there are triangles. From this level on groups
// are halved, so that the depth is at most this plus log2 of the number of triangles.
constexpr std::uint32_t maxBinnedLevel = 64;

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

    void run() {
        gatherItems();
        std::vector<std::uint32_t> tasks;
        for (std::size_t i = m_out.nodes.size(); i-- > 0;) {
            if (m_out.nodes[i].left == 0) {
                tasks.push_back(static_cast<std::uint32_t>(i));
            }
        }
        while (!tasks.empty()) {
            const std::uint32_t node = tasks.back();
            tasks.pop_back();
            const BinaryNode group = m_out.nodes[node];
            if (group.size() <= static_cast<std::uint32_t>(m_settings.maxLeafTriangles)) {
                continue;
            }
            const std::uint32_t middle = splitInTwo({group.begin, group.end}, group.level);
            const auto left = static_cast<std::uint32_t>(m_out.nodes.size());
            m_out.nodes[node].left = left;
            m_out.nodes[node].right = left + 1;
            m_out.nodes.push_back({group.begin, middle, 0, 0, 0, group.level + 1});
            m_out.nodes.push_back({middle, group.end, 0, 0, 0, group.level + 1});
            tasks.push_back(left + 1);
            tasks.push_back(left);
        }
        for (std::size_t i = 0; i < m_items.size(); ++i) {
            m_out.order[i] = m_items[i].triangle;
        }
        fillReach();
    }

  private:
    struct Range {
        std::uint32_t begin;
        std::uint32_t end;
        [[nodiscard]] std::uint32_t size() const { return end - begin; }
    };

    void gatherItems() {
        m_items.resize(m_out.order.size());
        for (std::size_t i = 0; i < m_items.size(); ++i) {
            m_items[i].triangle = m_out.order[i];
            for (const std::uint32_t corner : m_tree.triangles[m_items[i].triangle]) {
                Box point;
                for (int axis = 0; axis < 3; ++axis) {
                    point.lower[axis] = point.upper[axis] = m_tree.vertices[corner][axis];
                }
                m_items[i].box.grow(point);
            }
        }
    }

    /// Bottom-up: children stand after their parents.
    void fillReach() {
        std::vector<Box> boxes(m_out.nodes.size());
        for (std::size_t i = boxes.size(); i-- > 0;) {
            BinaryNode& node = m_out.nodes[i];
            if (node.left != 0) {
                boxes[i].grow(boxes[node.left]);
                boxes[i].grow(boxes[node.right]);
            } else {
                for (std::uint32_t item = node.begin; item < node.end; ++item) {
                    boxes[i].grow(m_items[item].box);
                }
            }
            node.reach = boxes[i].reach();
        }
    }

    /// Where the right part begins; both parts have at least one triangle.
    std::uint32_t splitInTwo(const Range& range, std::uint32_t level) {
        float low[3];
        float high[3];
        std::fill(low, low + 3, std::numeric_limits<float>::infinity());
        std::fill(high, high + 3, -std::numeric_limits<float>::infinity());
        for (std::size_t i = range.begin; i < range.end; ++i) {
            for (int axis = 0; axis < 3; ++axis) {
                low[axis] = std::min(low[axis], m_items[i].place(axis));
                high[axis] = std::max(high[axis], m_items[i].place(axis));
            }
        }
        if (level >= maxBinnedLevel) {
            return halve(range, low, high);
        }
        const Split split = bestSplit(range, low, high);
        if (split.axis < 0) {
            return halve(range, low, high);
        }
        const auto first = m_items.begin() + static_cast<std::ptrdiff_t>(range.begin);
        const auto last = m_items.begin() + static_cast<std::ptrdiff_t>(range.end);
        const auto middle = std::partition(first, last, [&](const Item& item) {
            return binOf(item.place(split.axis), split.low, split.scale) < split.bin;
        });
        return static_cast<std::uint32_t>(middle - m_items.begin());
    }

    /// By rank along the longest axis; by triangle index where all are at one place.
    std::uint32_t halve(const Range& range, const float (&low)[3], const float (&high)[3]) {
        int axis = 0;
        for (int other = 1; other < 3; ++other) {
            if (high[other] - low[other] > high[axis] - low[axis]) {
                axis = other;
            }
        }
        const std::uint32_t middle = range.begin + range.size() / 2;
        if (high[axis] > low[axis]) {
            std::sort(m_items.begin() + static_cast<std::ptrdiff_t>(range.begin),
                      m_items.begin() + static_cast<std::ptrdiff_t>(range.end), [axis](const Item& a, const Item& b) {
                          return a.place(axis) != b.place(axis) ? a.place(axis) < b.place(axis)
                                                                : a.triangle < b.triangle;
                      });
        }
        return middle;
    }

    [[nodiscard]] int binOf(float place, float low, float scale) const {
        return std::min(static_cast<int>((place - low) * scale), m_settings.bins - 1);
    }

    /// The cheapest split by reach times number of leaves on either side; axis -1 if no plane parts the triangles.
    Split bestSplit(const Range& range, const float (&low)[3], const float (&high)[3]) {
        Split best;
        double bestCost = std::numeric_limits<double>::infinity();
        const int bins = m_settings.bins;
        for (int axis = 0; axis < 3; ++axis) {
            const float scale = static_cast<float>(bins) / (high[axis] - low[axis]);
            if (!(scale < std::numeric_limits<float>::max())) {
                continue;  // no extent, or so little that its inverse overflows
            }
            Box boxes[maxBins];
            std::size_t counts[maxBins] = {};
            for (std::size_t i = range.begin; i < range.end; ++i) {
                const int bin = binOf(m_items[i].place(axis), low[axis], scale);
                boxes[bin].grow(m_items[i].box);
                ++counts[bin];
            }
            double rightCost[maxBins];
            Box box;
            std::size_t count = 0;
            for (int bin = bins - 1; bin > 0; --bin) {
                box.grow(boxes[bin]);
                count += counts[bin];
                rightCost[bin] = cost(box, count);
            }
            box = Box();
            count = 0;
            for (int bin = 1; bin < bins; ++bin) {
                box.grow(boxes[bin - 1]);
                count += counts[bin - 1];
                const double total = cost(box, count) + rightCost[bin];
                if (count > 0 && count < range.size() && total < bestCost) {
                    bestCost = total;
                    best = {axis, bin, low[axis], scale};
                }
            }
        }
        return best;
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
};

}  // namespace

void splitLeaves(const Tree& tree, const BuildSettings& settings, BinaryTree& binary) {
    Sorter(tree, settings, binary).run();
}

BinaryTree sortInTwos(const Tree& tree, const BuildSettings& settings) {
    BinaryTree all;
    all.order.resize(tree.triangles.size());
    std::iota(all.order.begin(), all.order.end(), 0U);
    all.nodes.push_back({0, static_cast<std::uint32_t>(all.order.size()), 0, 0, 0, 0});
    splitLeaves(tree, settings, all);
    return all;
}

}  // namespace grapeshot::detail
