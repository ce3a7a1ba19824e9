#include <algorithm>
#include <cmath>
#include <sstream>

#include <grapeshot/adb/detail/leaf_corners.hpp>
#include <grapeshot/adb/detail/surface_moments.hpp>
#include <grapeshot/adb/detail/tree_contents.hpp>
#include <grapeshot/adb/tree.hpp>

namespace grapeshot {
namespace {

/// Looks at a tree and writes down what is wrong. Shape first: the rest is only looked at if the shape is sound.
class Inspector {
  public:
    explicit Inspector(const Tree& tree) : m_tree(tree) {}

    std::vector<std::string> run() {
        checkCounts();
        if (m_findings.empty()) {
            checkChildren();
        }
        if (m_findings.empty()) {
            checkLeaves();
        }
        if (m_findings.empty()) {
            checkContents();
            checkExtent();
            checkWhole();
        }
        return m_findings;
    }

  private:
    template <typename... Words>
    void say(const Words&... words) {
        std::ostringstream line;
        (line << ... << words);
        m_findings.push_back(line.str());
    }

    void checkCounts() {
        if (m_tree.nodes.empty() || m_tree.leaves.empty()) {
            say("no nodes or no leaves");
        }
        if (m_tree.distributions.size() != m_tree.nodes.size()) {
            say(m_tree.distributions.size(), " distributions for ", m_tree.nodes.size(), " nodes");
        }
    }

    void checkChildren() {
        std::vector<int> nodeParents(m_tree.nodes.size(), 0);
        std::vector<int> leafParents(m_tree.leaves.size(), 0);
        for (std::size_t i = 0; i < m_tree.nodes.size(); ++i) {
            int children = 0;
            for (const ChildRef child : m_tree.nodes[i].child) {
                if (child == noChild) {
                    continue;
                }
                ++children;
                const std::size_t below = indexOf(child);
                if (isLeaf(child)) {
                    if (below >= leafParents.size()) {
                        say("node ", i, " names leaf ", below, " of ", leafParents.size());
                    } else {
                        ++leafParents[below];
                    }
                } else if (below >= nodeParents.size()) {
                    say("node ", i, " names node ", below, " of ", nodeParents.size());
                } else {
                    ++nodeParents[below];
                    if (below <= i) {
                        say("node ", i, " has a child ", below, " that does not stand after it");
                    }
                }
            }
            if (children == 0) {
                say("node ", i, " has no children");
            }
        }
        for (std::size_t i = 0; i < nodeParents.size(); ++i) {
            if (nodeParents[i] != (i == 0 ? 0 : 1)) {
                say("node ", i, " has ", nodeParents[i], " parents");
            }
        }
        for (std::size_t i = 0; i < leafParents.size(); ++i) {
            if (leafParents[i] != 1) {
                say("leaf ", i, " has ", leafParents[i], " parents");
            }
        }
    }

    void checkLeaves() {
        std::vector<int> seen(m_tree.triangles.size(), 0);
        for (std::size_t i = 0; i < m_tree.leaves.size(); ++i) {
            const LeafBlock& leaf = m_tree.leaves[i];
            bool ended = false;
            for (int lane = 0; lane < 4; ++lane) {
                const std::uint32_t named = leaf.triangle[lane];
                ended = ended || named == noTriangle;
                if (named != noTriangle && (ended || named >= seen.size())) {
                    say("leaf ", i, " lane ", lane, " names triangle ", named);
                    return;
                }
                if (named != noTriangle) {
                    ++seen[named];
                }
                checkCorners(leaf, i, lane);
            }
            if (leaf.triangle[0] == noTriangle) {
                say("leaf ", i, " is empty");
                return;
            }
        }
        for (std::size_t i = 0; i < seen.size(); ++i) {
            if (seen[i] != 1) {
                say("triangle ", i, " is in ", seen[i], " leaves");
            }
        }
    }

    void checkCorners(const LeafBlock& leaf, std::size_t index, int lane) {
        const std::uint32_t triangle = leaf.triangle[lane] == noTriangle ? leaf.triangle[0] : leaf.triangle[lane];
        if (triangle == noTriangle) {
            return;
        }
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const Eigen::Vector3f& vertex = m_tree.vertices[m_tree.triangles[triangle][corner]];
            for (int axis = 0; axis < 3; ++axis) {
                if (leaf.corner[corner][axis][lane] != vertex[axis]) {
                    say("leaf ", index, " lane ", lane, " corner ", corner, " is not its vertex");
                    return;
                }
            }
        }
    }

    void checkContents() {
        const std::vector<detail::LeafRange> ranges = detail::leafRanges(m_tree);
        for (std::size_t i = 0; i < m_tree.nodes.size(); ++i) {
            for (int slot = 0; slot < 4; ++slot) {
                const ChildRef child = m_tree.nodes[i].child[slot];
                if (child == noChild) {
                    for (const auto& half : m_tree.nodes[i].half) {
                        if (half[slot] != detail::emptyHalf) {
                            say("node ", i, " slot ", slot, " is empty but has a box");
                        }
                    }
                    continue;
                }
                const std::uint32_t below = indexOf(child);
                const detail::LeafRange range = isLeaf(child) ? detail::LeafRange{below, below + 1} : ranges[below];
                checkBounds(i, slot, range);
                checkMoments(i, slot, range);
            }
        }
    }

    void checkBounds(std::size_t index, int slot, detail::LeafRange range) {
        const Node& node = m_tree.nodes[index];
        double squaredNormal = 0;
        for (const auto& component : node.normal) {
            squaredNormal += double{component[slot]} * component[slot];
        }
        if (!(std::abs(squaredNormal - 1) < 1e-5)) {
            say("node ", index, " slot ", slot, ": normal of squared length ", squaredNormal);
        }
        for (std::uint32_t leaf = range.begin; leaf < range.end; ++leaf) {
            for (const auto& corner : m_tree.leaves[leaf].corner) {
                for (int lane = 0; lane < 4; ++lane) {
                    double height = 0;
                    for (int axis = 0; axis < 3; ++axis) {
                        const double x = corner[axis][lane];
                        height += node.normal[axis][slot] * (x - node.center[axis][slot]);
                        if (std::abs(x - node.center[axis][slot]) > node.half[axis][slot]) {
                            say("node ", index, " slot ", slot, ": leaf ", leaf, " sticks out of the box");
                            return;
                        }
                    }
                    if (height < node.slabLow[slot] || height > node.slabHigh[slot]) {
                        say("node ", index, " slot ", slot, ": leaf ", leaf, " sticks out of the slab");
                        return;
                    }
                }
            }
        }
    }

    /// Against the plain sum over all triangles below.
    void checkMoments(std::size_t index, int slot, detail::LeafRange range) {
        std::vector<detail::SurfaceMoments> pieces;
        double extent = 0;
        for (std::uint32_t i = range.begin; i < range.end; ++i) {
            const LeafBlock& leaf = m_tree.leaves[i];
            for (int lane = 0; lane < 4 && leaf.triangle[lane] != noTriangle; ++lane) {
                Eigen::Vector3d corner[3];
                for (int c = 0; c < 3; ++c) {
                    corner[c] = detail::cornerOf(leaf, c, lane);
                    extent = std::max(extent, corner[c].lpNorm<Eigen::Infinity>());
                }
                pieces.push_back(detail::momentsOf(corner[0], corner[1], corner[2]));
            }
        }
        const detail::SurfaceMoments truth = detail::sum(pieces.data(), static_cast<int>(pieces.size()));
        const Node& node = m_tree.nodes[index];
        const ChildSurface stored = surfaceOf(node, m_tree.distributions[index], slot);
        double size = 0;
        for (const auto& half : node.half) {
            size = std::max(size, double{half[slot]});
        }
        // Not beyond the steps of the bytes.
        bool wrong = std::abs(stored.area - truth.area) > 0.002 * truth.area + 1e-30;
        const Eigen::Matrix3d covariance =
            truth.covariance + detail::thickening * truth.covariance.trace() * Eigen::Matrix3d::Identity();
        for (int axis = 0; axis < 3 && truth.area > 0; ++axis) {
            wrong = wrong || std::abs(stored.mean[axis] - truth.mean[axis]) > size / 250 + 1e-6 * extent;
            for (int other = 0; other < 3; ++other) {
                wrong = wrong || std::abs(stored.covariance(axis, other) - covariance(axis, other)) >
                                     0.02 * size * size + 1e-12 * extent * extent;
            }
        }
        const double flatness = truth.area > 0 ? truth.normalSum.norm() / truth.area : 0;
        wrong = wrong || std::abs(stored.flatness - flatness) > 0.005;
        if (wrong) {
            say("node ", index, " slot ", slot, ": the distribution is not that of its triangles");
        }
    }

    void checkExtent() {
        for (const LeafBlock& leaf : m_tree.leaves) {
            for (const auto& corner : leaf.corner) {
                for (int lane = 0; lane < 4; ++lane) {
                    double squared = 0;
                    for (int axis = 0; axis < 3; ++axis) {
                        const float x = corner[axis][lane];
                        squared += double{x} * x;
                        if (x < m_tree.lower[axis] || x > m_tree.upper[axis]) {
                            say("a triangle sticks out of the tree's box");
                            return;
                        }
                    }
                    if (std::sqrt(squared) > m_tree.radius) {
                        say("a triangle sticks out of the tree's radius");
                        return;
                    }
                }
            }
        }
    }

    /// Against the plain sum over all triangles.
    void checkWhole() {
        std::vector<detail::SurfaceMoments> pieces;
        for (const Triangle& triangle : m_tree.triangles) {
            const auto corner = [&](int i) { return m_tree.vertices[triangle[i]].cast<double>().eval(); };
            pieces.push_back(detail::momentsOf(corner(0), corner(1), corner(2)));
        }
        const detail::SurfaceMoments truth = detail::sum(pieces.data(), static_cast<int>(pieces.size()));
        const WholeSurface& whole = m_tree.whole;
        const double unit = whole.unit;
        const double extent = m_tree.radius;
        const Eigen::Matrix3d covariance =
            truth.covariance + detail::thickening * truth.covariance.trace() * Eigen::Matrix3d::Identity();
        bool wrong = !(unit > 0) || whole.mean[3] != 0;
        for (int axis = 0; axis < 3; ++axis) {
            wrong = wrong || !(std::abs(whole.mean[axis] - truth.mean[axis]) <= 1e-6 * extent);
            wrong = wrong || whole.covariance[axis][3] != 0;
            for (int other = 0; other < 3; ++other) {
                const double stored = unit * unit * whole.covariance[axis][other];
                wrong = wrong || !(std::abs(stored - covariance(other, axis)) <=
                                   1e-5 * covariance.trace() + 1e-12 * extent * extent);
            }
        }
        if (!std::ranges::all_of(m_tree.stepRates, [](float rate) { return rate >= 0x1p-4F && rate <= 0x1p4F; })) {
            say("its tuning is out of range");
        }
        if (wrong && truth.area > 0) {
            say("the distribution of the whole surface is not that of its triangles");
        }
    }

    const Tree& m_tree;
    std::vector<std::string> m_findings;
};

}  // namespace

std::vector<std::string> findings(const Tree& tree) {
    return Inspector(tree).run();
}

}  // namespace grapeshot
