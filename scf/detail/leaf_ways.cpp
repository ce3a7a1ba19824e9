#include <grapeshot/scf/detail/leaf_ways.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace grapeshot::detail {

LeafWays::LeafWays(const BallTree& tree) : m_tree(&tree), m_stamps(tree.leaves.size(), 0), m_ways(tree.leaves.size()) {}

void LeafWays::begin(std::span<const Eigen::Vector3f> last, std::span<const Eigen::Vector3f> before,
                     std::span<const Eigen::Vector3f> after) {
    m_before = before;
    m_ends = {last, after};
    if (++m_step == 0) {  // after 2^32 of them
        std::ranges::fill(m_stamps, 0);
        m_step = 1;
    }
}

const LeafWay& LeafWays::of(std::uint32_t leaf) {
    LeafWay& way = m_ways[leaf];
    if (m_stamps[leaf] == m_step) {
        return way;
    }
    m_stamps[leaf] = m_step;
    const auto vertices = m_tree->leafVertices.of(leaf);
    way.low = way.high = m_before[vertices.front()];
    for (const std::uint32_t vertex : vertices) {
        way.low = way.low.cwiseMin(m_before[vertex]);
        way.high = way.high.cwiseMax(m_before[vertex]);
    }
    for (std::size_t i = 0; i < 2; ++i) {
        Eigen::Vector3f least = wayOf(vertices.front(), i);
        Eigen::Vector3f most = least;
        for (const std::uint32_t vertex : vertices) {
            const Eigen::Vector3f own = wayOf(vertex, i);
            least = least.cwiseMin(own);
            most = most.cwiseMax(own);
        }
        way.mean[i] = 0.5F * (least + most);
        way.besides[i] = (most - way.mean[i]).cwiseMax(way.mean[i] - least);
    }
    return way;
}

void LeafWays::sweep(std::uint32_t index, std::size_t way, const Eigen::Vector3f& mean, PosedLeaf& out) const {
    const BallLeaf& leaf = m_tree->leaves[index];
    for (int axis = 0; axis < 3; ++axis) {
        std::ranges::fill(out.low[axis], std::numeric_limits<float>::infinity());
        std::ranges::fill(out.high[axis], -std::numeric_limits<float>::infinity());
    }
    for (std::uint32_t lane = 0; lane < leaf.count; ++lane) {
        for (const auto& corner : leaf.corner) {
            const std::uint32_t vertex = corner[lane];
            const Eigen::Vector3f from = m_before[vertex];
            const Eigen::Vector3f to = m_ends[way][vertex] - mean;
            for (int axis = 0; axis < 3; ++axis) {
                out.low[axis][lane] = std::min({out.low[axis][lane], from[axis], to[axis]});
                out.high[axis][lane] = std::max({out.high[axis][lane], from[axis], to[axis]});
            }
        }
    }
    for (int axis = 0; axis < 3; ++axis) {
        out.boxLow[axis] = *std::ranges::min_element(out.low[axis]);
        out.boxHigh[axis] = *std::ranges::max_element(out.high[axis]);
    }
}

float LeafWays::longest() const {
    float most = 0;
    for (const auto& end : m_ends) {
        for (std::size_t i = 0; i < m_before.size(); ++i) {
            most = std::max(most, (end[i] - m_before[i]).squaredNorm());
        }
    }
    return std::sqrt(most);
}

bool mayMeet(const LeafWay& a, const LeafWay& b, std::size_t way, float reach) {
    for (int axis = 0; axis < 3; ++axis) {
        const float together = a.mean[way][axis] - b.mean[way][axis];
        const float wide = a.besides[way][axis] + b.besides[way][axis] + reach;
        if (a.low[axis] + std::min(0.0F, together) > b.high[axis] + wide ||
            a.high[axis] + std::max(0.0F, together) < b.low[axis] - wide) {
            return false;
        }
    }
    return true;
}

}  // namespace grapeshot::detail
