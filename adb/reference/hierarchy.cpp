#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>
#include <string>

#include <Eigen/Geometry>
#include <grapeshot/adb/reference/tree.hpp>
#include <grapeshot/core/error.hpp>
#include <grapeshot/core/mesh_report.hpp>

namespace grapeshot::reference {

namespace {

using Corners = std::array<Eigen::Vector3d, 3>;

struct Item {
    Corners corners;
    Box box;
    std::uint32_t id = 0;
};

class Builder {
  public:
    Builder(MeshView mesh, int mostPerLeaf) : m_mostPerLeaf(static_cast<std::uint32_t>(mostPerLeaf)) {
        m_items.reserve(mesh.triangles.size());
        for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
            Item item;
            item.id = t;
            for (std::size_t c = 0; c < 3; ++c) {
                item.corners[c] = mesh.vertices[mesh.triangles[t][c]].cast<double>();
                item.box.grow(item.corners[c]);
                m_result.radius = std::max(m_result.radius, item.corners[c].norm());
            }
            m_items.push_back(item);
        }
    }

    Hierarchy run() {
        m_result.nodes.push_back({.end = static_cast<std::uint32_t>(m_items.size())});
        for (std::size_t index = 0; index < m_result.nodes.size(); ++index) {
            const TreeNode node = m_result.nodes[index];
            m_result.nodes[index].coneHalfAngle = coneHalfAngle(node);
            m_result.maxDepth = std::max(m_result.maxDepth, node.depth);
            if (node.end - node.begin <= m_mostPerLeaf) {
                continue;
            }
            const std::uint32_t middle = split(node);
            m_result.nodes[index].left = static_cast<std::uint32_t>(m_result.nodes.size());
            m_result.nodes.push_back({.begin = node.begin, .end = middle, .depth = node.depth + 1});
            m_result.nodes.push_back({.begin = middle, .end = node.end, .depth = node.depth + 1});
        }
        for (const Item& item : m_items) {
            m_result.triangles.push_back(item.corners);
            m_result.triangleIds.push_back(item.id);
        }
        return std::move(m_result);
    }

  private:
    void sortAlong(const TreeNode& node, int axis) {
        const auto place = [axis](const Item& item) { return item.box.lower[axis] + item.box.upper[axis]; };
        std::sort(m_items.begin() + node.begin, m_items.begin() + node.end, [&](const Item& a, const Item& b) {
            return place(a) != place(b) ? place(a) < place(b) : a.id < b.id;
        });
    }

    /// Where the right part begins. Within the middle half: a split that peels off a triangle at a time would make one
    /// branch so deep that LB, a share of the greatest depth, is small everywhere else.
    std::uint32_t split(const TreeNode& node) {
        const std::uint32_t size = node.end - node.begin;
        const std::uint32_t first = std::max(1U, size / 4);
        const std::uint32_t last = std::max(first, size - std::max(1U, size / 4));
        double best = INFINITY;
        int bestAxis = 0;
        std::uint32_t middle = node.begin + size / 2;
        for (int axis = 0; axis < 3; ++axis) {
            sortAlong(node, axis);
            std::vector<double> rightVolume(size + 1, 0);
            Box right;
            for (std::uint32_t i = size; i-- > 0;) {
                right.grow(m_items[node.begin + i].box);
                rightVolume[i] = thickened(right).sides().prod();
            }
            Box left;
            for (std::uint32_t i = 1; i <= last; ++i) {
                left.grow(m_items[node.begin + i - 1].box);
                const double sum = thickened(left).sides().prod() + rightVolume[i];
                // Equal sums, as of copies of one triangle: the more even split.
                const auto uneven = [size](std::uint32_t at) { return std::abs(2.0 * at - size); };
                if (i >= first && (sum < best || (sum == best && uneven(i) < uneven(middle - node.begin)))) {
                    best = sum;
                    bestAxis = axis;
                    middle = node.begin + i;
                }
            }
        }
        sortAlong(node, bestAxis);
        return middle;
    }

    [[nodiscard]] double coneHalfAngle(const TreeNode& node) const {
        const auto twiceArea = [](const Item& item) -> Eigen::Vector3d {
            return (item.corners[1] - item.corners[0]).cross(item.corners[2] - item.corners[0]);
        };
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        double total = 0;
        for (std::uint32_t i = node.begin; i < node.end; ++i) {
            sum += twiceArea(m_items[i]);
            total += twiceArea(m_items[i]).norm();
        }
        if (!(sum.norm() > 1e-6 * total)) {
            return total > 0 ? std::numbers::pi : 0;
        }
        double least = 1;
        for (std::uint32_t i = node.begin; i < node.end; ++i) {
            const Eigen::Vector3d normal = twiceArea(m_items[i]);
            if (normal.norm() > 0) {
                least = std::min(least, normal.normalized().dot(sum.normalized()));
            }
        }
        return std::acos(std::clamp(least, -1.0, 1.0));
    }

    std::uint32_t m_mostPerLeaf;
    std::vector<Item> m_items;
    Hierarchy m_result;
};

}  // namespace

Hierarchy buildHierarchy(MeshView mesh, int mostPerLeaf) {
    grapeshot::requireUsable(mesh);
    if (mostPerLeaf < 1) {
        throw Error(Fault::badSetting, "mostPerLeaf is " + std::to_string(mostPerLeaf) + ", not 1 or more", "settings");
    }
    return Builder(mesh, mostPerLeaf).run();
}

std::span<const Eigen::Vector3d> cornersOf(const Hierarchy& hierarchy, const TreeNode& node) {
    static_assert(sizeof(Corners) == 3 * sizeof(Eigen::Vector3d));
    return {hierarchy.triangles[node.begin].data(), 3 * std::size_t{node.end - node.begin}};
}

}  // namespace grapeshot::reference
