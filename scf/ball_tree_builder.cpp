#include <grapeshot/scf/ball_tree_builder.hpp>

#include <algorithm>
#include <limits>
#include <utility>

#include <grapeshot/scf/detail/piece_measure.hpp>
#include <grapeshot/scf/detail/piece_split.hpp>
#include <grapeshot/scf/detail/sliced_vectors.hpp>
#include <grapeshot/scf/detail/triangle_order.hpp>

namespace grapeshot {
namespace {

using detail::ballLeafSize;
using detail::verticesPerUnit;
using Range = detail::TriangleRange;

/// In the order of a recursion, every step of which says what it costs.
class Builder {
  public:
    explicit Builder(BallTree& tree)
        : m_tree(tree), m_triangles(tree.surface), m_measure(m_triangles), m_split(m_triangles, m_measure) {}

    Sliced run() {
        co_await prepare();
        m_tree.leafVertices.begin.push_back(0);
        constexpr float infinity = std::numeric_limits<float>::infinity();
        const PieceBall root{m_tree.surface.triangles[0][0], infinity, infinity};
        const Range all{0, static_cast<std::uint32_t>(m_triangles.order.size())};
        if (all.size() <= ballLeafSize) {
            std::vector<Range> whole(1, all);
            co_await fillSlots(newNode(root), std::move(whole));
        } else {
            BallRef ignored = noBall;
            co_await addNode(all, root, ignored);
        }
    }

  private:
    Sliced prepare() {
        co_await m_triangles.prepare();
        co_await m_measure.prepare();
        const std::size_t triangles = m_tree.surface.triangles.size();
        // What grows would be copied in one piece. Of a mesh in one piece all leaves are full but one.
        const std::size_t leaves = (triangles + ballLeafSize - 1) / ballLeafSize;
        m_tree.leaves.reserve(leaves);
        m_tree.leafVertices.begin.reserve(leaves + 1);
        m_tree.leafVertices.all.reserve(triangles);
        m_tree.nodes.reserve(leaves / 2 + 1);
        m_tree.restBalls.reserve(leaves / 2 + 1);
        m_tree.plainBalls.reserve(leaves / 2 + 1);
        co_await detail::fillInSlices(m_tree.leafOfTriangle, triangles, 0U);
    }

    std::uint32_t newNode(const PieceBall& own) {
        const auto index = static_cast<std::uint32_t>(m_tree.nodes.size());
        m_tree.nodes.push_back({});
        m_tree.nodes[index].own = own;
        m_tree.restBalls.push_back({});
        m_tree.plainBalls.push_back({});
        return index;
    }

    Sliced addNode(Range range, PieceBall own, BallRef& made) {
        const std::uint32_t index = newNode(own);
        std::vector<Range> halves;
        std::vector<Range> parts;
        co_await m_split.split(range, halves);
        for (const Range& half : halves) {
            if (half.size() <= ballLeafSize) {
                parts.push_back(half);
            } else {
                std::vector<Range> quarters;
                co_await m_split.split(half, quarters);
                parts.insert(parts.end(), quarters.begin(), quarters.end());
            }
        }
        co_await fillSlots(index, std::move(parts));
        made = index;
    }

    Sliced fillSlots(std::uint32_t index, std::vector<Range> parts) {
        for (std::size_t slot = 0; slot < 4; ++slot) {
            m_tree.nodes[index].center[slot] = 0;
            m_tree.nodes[index].radius[slot] = 0;
            m_tree.nodes[index].child[slot] = noBall;
        }
        m_tree.nodes[index].count = static_cast<std::uint32_t>(parts.size());
        for (std::size_t slot = 0; slot < parts.size(); ++slot) {
            const Range part = parts[slot];
            PieceBall own;
            co_await m_measure.putBallAround(part, own);
            m_tree.nodes[index].center[slot] = own.center;
            m_tree.nodes[index].radius[slot] = own.radius;
            const Eigen::Vector3f middle = m_tree.surface.rest[own.center];
            float reach = 0;
            const auto measure = [&](std::size_t begin, std::size_t end) {
                for (std::size_t i = begin; i < end; ++i) {
                    reach = std::max(reach, (m_triangles.middle[m_triangles.order[i]] - middle).norm());
                }
            };
            co_await inPieces(part.begin, part.end, verticesPerUnit, measure);
            for (int axis = 0; axis < 3; ++axis) {
                m_tree.restBalls[index].center[axis][slot] = middle[axis];
            }
            own.restRadius = reach * 1.00001F;
            m_tree.restBalls[index].radius[slot] = own.restRadius;
            co_await m_measure.setPlainBall(part, own);
            for (int axis = 0; axis < 3; ++axis) {
                m_tree.plainBalls[index].center[axis][slot] = own.plainCenter[axis];
            }
            m_tree.plainBalls[index].radius[slot] = own.plainRadius;
            BallRef child = noBall;
            if (part.size() <= ballLeafSize) {
                co_await addLeaf(part, own, child);
            } else {
                co_await addNode(part, own, child);
            }
            m_tree.nodes[index].child[slot] = child;
        }
    }

    Sliced addLeaf(Range range, PieceBall own, BallRef& made) {
        co_yield 6;
        const auto index = static_cast<std::uint32_t>(m_tree.leaves.size());
        // In the caller's order: neighbours in memory are then likelier neighbours here.
        std::sort(m_triangles.order.begin() + range.begin, m_triangles.order.begin() + range.end);
        BallLeaf leaf{};
        leaf.own = own;
        leaf.count = static_cast<std::uint32_t>(range.size());
        for (std::size_t lane = 0; lane < ballLeafSize; ++lane) {
            const bool used = lane < range.size();
            const std::uint32_t t = m_triangles.order[range.begin + (used ? lane : 0)];
            leaf.triangle[lane] = used ? t : noTriangle;
            for (std::size_t corner = 0; corner < 3; ++corner) {
                leaf.corner[corner][lane] = m_tree.surface.triangles[t][corner];
            }
            for (int axis = 0; axis < 3; ++axis) {
                leaf.middle[axis][lane] = m_triangles.middle[t][axis];
            }
            if (used) {
                m_tree.leafOfTriangle[t] = index;
            }
        }
        m_tree.leaves.push_back(leaf);
        co_await m_triangles.gather(range);
        m_tree.leafVertices.all.insert(m_tree.leafVertices.all.end(), m_triangles.vertices.begin(),
                                       m_triangles.vertices.end());
        m_tree.leafVertices.begin.push_back(static_cast<std::uint32_t>(m_tree.leafVertices.all.size()));
        made = index | ballLeafBit;
    }

    BallTree& m_tree;
    detail::TriangleOrder m_triangles;
    detail::PieceMeasure m_measure;
    detail::PieceSplit m_split;
};

}  // namespace

Sliced buildBallTreeInSlices(MeshView rest, BallTree& tree) {
    co_await makeSurfaceInSlices(rest, tree.surface);
    Builder builder(tree);
    co_await builder.run();
    const auto measure = [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v) {
            tree.extent = std::max(tree.extent, tree.surface.rest[v].norm());
        }
    };
    co_await inPieces(0, tree.surface.rest.size(), verticesPerUnit, measure);
}

BallTree buildBallTree(MeshView rest) {
    BallTree tree;
    buildBallTreeInSlices(rest, tree).run();
    return tree;
}

}  // namespace grapeshot
