// Which pieces are connected: a search over neighbours, sixteen at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace grapeshot::detail {

/// Balls in space, each with a direction, side by side. Sixteen that follow each other are a block, with a ball around
/// all of them: those that are neighbours had better stand near each other.
class FloodPieces {
  public:
    /// Empty, with room for so many. Memory is kept.
    void reset(std::size_t most);
    [[nodiscard]] std::size_t size() const { return m_count; }
    /// @param direction unit
    void add(const Eigen::Vector3f& position, const Eigen::Vector3f& direction, float radius) {
        float* const entry = m_columns.data()->lane + m_count++;
        for (int axis = 0; axis < 3; ++axis) {
            entry[static_cast<std::size_t>(axis) * m_stride] = position[axis];
            entry[static_cast<std::size_t>(axis + 3) * m_stride] = direction[axis];
        }
        entry[6 * m_stride] = radius;
    }
    /// When all are there: makes the blocks, and all of them candidates.
    void finish();

    [[nodiscard]] Eigen::Vector3f position(std::size_t i) const {
        const float* const entry = m_columns.data()->lane + i;
        return {entry[0], entry[m_stride], entry[2 * m_stride]};
    }
    [[nodiscard]] Eigen::Vector3f direction(std::size_t i) const {
        const float* const entry = m_columns.data()->lane + i + 3 * m_stride;
        return {entry[0], entry[m_stride], entry[2 * m_stride]};
    }
    [[nodiscard]] bool isCandidate(std::size_t i) const { return (m_candidates[i / 16] >> (i % 16) & 1U) != 0; }
    void makeCandidate(std::size_t i) { m_candidates[i / 16] |= 1U << (i % 16); }

    /// From the seed over all candidates no farther from one found than the spacing and both radii, and, with an axis,
    /// with a direction within a cone about it (its cosine). Those found are no candidates any more.
    void flood(std::uint32_t seed, float spacing, const Eigen::Vector3f* axis, float cone,
               std::vector<std::uint32_t>& found);

    /// What the kernel sees. Columns have room for whole blocks.
    struct View {
        const float* columns;  ///< position x, y, z, direction x, y, z, radius; `stride` floats each
        std::size_t stride;
        const float* blocks;  ///< middle x, y, z and radius of each block; `blockStride` floats each
        std::size_t blockStride;
        std::size_t blockCount;
        std::uint32_t* candidates;
    };
    /// So few blocks are looked at one by one, without their balls.
    static constexpr std::size_t fewBlocks = 4;

  private:
    struct alignas(64) Sixteen {
        float lane[16];
    };

    std::size_t m_count = 0;
    std::size_t m_stride = 0;
    std::size_t m_blockStride = 0;
    std::vector<Sixteen> m_columns;
    std::vector<Sixteen> m_blocks;
    std::vector<std::uint32_t> m_candidates;
};

}  // namespace grapeshot::detail
