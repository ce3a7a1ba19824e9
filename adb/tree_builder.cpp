// From triangles to the shape of a tree: who is together in a leaf, who under one node. What the nodes say of their
// contents is filled in by detail/tree_contents.
//
// This work is based on:
// Ingo Wald. On fast Construction of SAH-based Bounding Volume Hierarchies. 2007 (bins)
// Ingo Wald, Carsten Benthin, Solomon Boulos. Getting Rid of Packets. 2008 (four children by splitting the largest)
#include <algorithm>
#include <limits>

#include <grapeshot/adb/detail/tree_contents.hpp>
#include <grapeshot/adb/tree.hpp>
#include <grapeshot/core/error.hpp>
#include <grapeshot/core/mesh_report.hpp>

namespace grapeshot {
namespace {

constexpr int maxBins = 64;
// Binned splits that peel off a triangle at a time could go as deep as there are triangles. From this binary level on
// ranges are halved, so that the depth is at most this plus log2 of the number of triangles.
constexpr int maxBinnedLevel = 64;
// Twice the node index, twice again the slot, and the leaf bit must fit into 32 bits (see detail/pair_stack.hpp).
constexpr std::size_t maxTriangles = std::size_t{1} << 28U;

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

struct Range {
    std::size_t begin = 0;
    std::size_t end = 0;
    int level = 0;     ///< binary splits above
    double reach = 0;  ///< of the box of the range
    [[nodiscard]] std::size_t size() const { return end - begin; }
};

struct Split {
    int axis = -1;
    int bin = 0;  ///< the first bin on the right side
    float low = 0;
    float scale = 0;  ///< bins per metre of place()
};

class Builder {
  public:
    Builder(Tree& tree, const BuildSettings& settings) : m_tree(tree), m_settings(settings) {}

    void run() {
        gatherItems();
        struct Task {
            std::uint32_t node;
            Range range;
        };
        std::vector<Task> tasks;
        m_tree.nodes.emplace_back();
        tasks.push_back({0, {0, m_items.size(), 0, 0}});
        while (!tasks.empty()) {
            const Task task = tasks.back();
            tasks.pop_back();
            Range parts[4];
            const int count = splitInFour(task.range, parts);
            // Siblings stand side by side, and a subtree's leaves are consecutive: the last pushed is done first.
            std::size_t inner[4];
            int innerCount = 0;
            for (int slot = 0; slot < 4; ++slot) {
                ChildRef child = noChild;
                if (slot < count) {
                    if (parts[slot].size() <= static_cast<std::size_t>(m_settings.maxLeafTriangles)) {
                        child = leafBit | makeLeaf(parts[slot]);
                    } else {
                        child = static_cast<ChildRef>(m_tree.nodes.size());
                        m_tree.nodes.emplace_back();
                        inner[innerCount++] = static_cast<std::size_t>(slot);
                    }
                }
                m_tree.nodes[task.node].child[slot] = child;
            }
            while (innerCount > 0) {
                const std::size_t slot = inner[--innerCount];
                tasks.push_back({m_tree.nodes[task.node].child[slot], parts[slot]});
            }
        }
    }

  private:
    void gatherItems() {
        m_items.resize(m_tree.triangles.size());
        for (std::size_t i = 0; i < m_items.size(); ++i) {
            m_items[i].triangle = static_cast<std::uint32_t>(i);
            for (const std::uint32_t corner : m_tree.triangles[i]) {
                Box point;
                for (int axis = 0; axis < 3; ++axis) {
                    point.lower[axis] = point.upper[axis] = m_tree.vertices[corner][axis];
                }
                m_items[i].box.grow(point);
            }
        }
    }

    [[nodiscard]] double reachOf(std::size_t begin, std::size_t end) const {
        Box box;
        for (std::size_t i = begin; i < end; ++i) {
            box.grow(m_items[i].box);
        }
        return box.reach();
    }

    /// Splits the part with the largest reach until there are four.
    int splitInFour(const Range& range, Range (&parts)[4]) {
        int count = 1;
        parts[0] = range;
        while (count < 4) {
            int best = -1;
            for (int i = 0; i < count; ++i) {
                if (parts[i].size() > static_cast<std::size_t>(m_settings.maxLeafTriangles) &&
                    (best < 0 || parts[i].reach > parts[best].reach)) {
                    best = i;
                }
            }
            if (best < 0) {
                break;
            }
            const Range whole = parts[best];
            const std::size_t middle = splitInTwo(whole);
            for (int i = count; i > best + 1; --i) {
                parts[i] = parts[i - 1];
            }
            parts[best] = {whole.begin, middle, whole.level + 1, reachOf(whole.begin, middle)};
            parts[best + 1] = {middle, whole.end, whole.level + 1, reachOf(middle, whole.end)};
            ++count;
        }
        return count;
    }

    /// Where the right part begins; both parts have at least one triangle.
    std::size_t splitInTwo(const Range& range) {
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
        if (range.level >= maxBinnedLevel) {
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
        return static_cast<std::size_t>(middle - m_items.begin());
    }

    /// By rank along the longest axis; by triangle index where all are at one place.
    std::size_t halve(const Range& range, const float (&low)[3], const float (&high)[3]) {
        int axis = 0;
        for (int other = 1; other < 3; ++other) {
            if (high[other] - low[other] > high[axis] - low[axis]) {
                axis = other;
            }
        }
        const std::size_t middle = range.begin + range.size() / 2;
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
        return box.reach() * static_cast<double>((count + leaf - 1) / leaf);
    }

    std::uint32_t makeLeaf(const Range& range) {
        LeafBlock& leaf = m_tree.leaves.emplace_back();
        for (std::size_t lane = 0; lane < 4; ++lane) {
            leaf.triangle[lane] = lane < range.size() ? m_items[range.begin + lane].triangle : noTriangle;
        }
        std::sort(leaf.triangle, leaf.triangle + range.size());
        return static_cast<std::uint32_t>(m_tree.leaves.size() - 1);
    }

    Tree& m_tree;
    const BuildSettings& m_settings;
    std::vector<Item> m_items;
};

}  // namespace

Tree build(MeshView mesh, const BuildSettings& settings) {
    requireUsable(mesh);
    if (settings.maxLeafTriangles < 1 || settings.maxLeafTriangles > 4) {
        throw Error(Fault::badSetting, std::to_string(settings.maxLeafTriangles) + " is not in 1..4",
                    "BuildSettings::maxLeafTriangles");
    }
    if (settings.bins < 4 || settings.bins > maxBins) {
        throw Error(Fault::badSetting, std::to_string(settings.bins) + " is not in 4..64", "BuildSettings::bins");
    }
    if (mesh.triangles.size() > maxTriangles) {
        throw Error(Fault::tooLarge, std::to_string(mesh.triangles.size()) + " triangles, more than 2^28", "mesh");
    }
    Tree tree;
    tree.vertices.assign(mesh.vertices.begin(), mesh.vertices.end());
    tree.triangles.assign(mesh.triangles.begin(), mesh.triangles.end());
    Builder(tree, settings).run();
    tree.nodes.shrink_to_fit();
    tree.leaves.shrink_to_fit();
    detail::fillContents(tree);
    return tree;
}

}  // namespace grapeshot
