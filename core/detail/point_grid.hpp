// Points in space, taken out by neighbourhood: each point is found once, so that a breadth-first search over
// neighbours costs O(n) in all.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

namespace grapeshot::detail {

/// Hash grid of cubic cells. Buckets are chains; two cells may share one, so the caller tests the distance itself.
class PointGrid {
  public:
    /// Empty, for up to `count` points that are asked for within `reach` (m, > 0) of each other. Memory is kept.
    void reset(std::size_t count, float reach) {
        // A chain through all points is faster than look-ups for small numbers.
        m_oneChain = count <= 32;
        // Twice the reach: then a neighbourhood touches 8 cells, of 27 otherwise.
        m_inverseCell = 0.5 / static_cast<double>(reach);
        m_head.assign(m_oneChain ? 1 : std::bit_ceil(2 * count), nobody);
        m_next.assign(count, nobody);
    }

    /// Insert in descending order of index to be asked in ascending order.
    void insert(std::uint32_t index, const Eigen::Vector3f& point) {
        std::uint32_t& head = m_head[m_oneChain ? 0 : bucket(cellOf(point, 0))];
        m_next[index] = head;
        head = index;
    }

    /// Asks accept(index) of every point that may be within the reach of `point`; those accepted are taken out.
    template <class Accept>
    void take(const Eigen::Vector3f& point, Accept&& accept) {
        if (m_oneChain) {
            takeFrom(0, accept);
            return;
        }
        // The cells that hold the corners of the cube of half a cell around the point.
        const Cell low = cellOf(point, -0.5);
        const Cell high = cellOf(point, 0.5);
        for (std::int64_t x = low[0]; x <= high[0]; ++x) {
            for (std::int64_t y = low[1]; y <= high[1]; ++y) {
                for (std::int64_t z = low[2]; z <= high[2]; ++z) {
                    takeFrom(bucket({x, y, z}), accept);
                }
            }
        }
    }

  private:
    using Cell = std::array<std::int64_t, 3>;
    static constexpr std::uint32_t nobody = 0xffffffffU;

    /// Of the point moved by so many cells along each axis.
    [[nodiscard]] Cell cellOf(const Eigen::Vector3f& point, double shift) const {
        // Far outside the range of integers all points fall into one cell: slower, still right.
        constexpr double limit = 4e15;
        Cell cell{};
        for (int axis = 0; axis < 3; ++axis) {
            const double scaled = std::floor(static_cast<double>(point[axis]) * m_inverseCell + shift);
            cell[static_cast<std::size_t>(axis)] = static_cast<std::int64_t>(std::clamp(scaled, -limit, limit));
        }
        return cell;
    }
    [[nodiscard]] std::size_t bucket(const Cell& cell) const {
        std::uint64_t hash = static_cast<std::uint64_t>(cell[0]) * 0x9e3779b97f4a7c15U;
        hash ^= static_cast<std::uint64_t>(cell[1]) * 0xc2b2ae3d27d4eb4fU;
        hash ^= static_cast<std::uint64_t>(cell[2]) * 0x165667b19e3779f9U;
        hash ^= hash >> 29U;
        hash *= 0xbf58476d1ce4e5b9U;
        return static_cast<std::size_t>(hash >> 32U) & (m_head.size() - 1);
    }
    template <class Accept>
    void takeFrom(std::size_t bucket, Accept& accept) {
        std::uint32_t* link = &m_head[bucket];
        while (*link != nobody) {
            const std::uint32_t index = *link;
            if (accept(index)) {
                *link = m_next[index];
            } else {
                link = &m_next[index];
            }
        }
    }

    std::vector<std::uint32_t> m_head;
    std::vector<std::uint32_t> m_next;
    double m_inverseCell = 1;
    bool m_oneChain = true;
};

}  // namespace grapeshot::detail
