// How the leaves of a ball tree move within a step: each as a whole, and what its vertices move beside that.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <grapeshot/scf/ball_tree.hpp>
#include <grapeshot/scf/detail/ball_kernels.hpp>

namespace grapeshot::detail {

/// One leaf. A way goes from where the leaf is between the two ways, back or ahead.
struct LeafWay {
    Eigen::Vector3f low, high;               ///< m
    std::array<Eigen::Vector3f, 2> mean;     ///< back, ahead, m
    std::array<Eigen::Vector3f, 2> besides;  ///< of any vertex, per axis at most, m
};

/// Made when it is asked for. Not for two threads; references hold until the next `begin`.
class LeafWays {
  public:
    explicit LeafWays(const BallTree& tree);
    void begin(std::span<const Eigen::Vector3f> last, std::span<const Eigen::Vector3f> before,
               std::span<const Eigen::Vector3f> after);
    const LeafWay& of(std::uint32_t leaf);
    /// Boxes around the ways of a leaf's triangles, less what `mean` says; of unused lanes such that nothing is near.
    /// Only `low`, `high`, `boxLow` and `boxHigh` are filled in.
    void sweep(std::uint32_t leaf, std::size_t way, const Eigen::Vector3f& mean, PosedLeaf& out) const;
    /// Longest, m.
    [[nodiscard]] float longest() const;

  private:
    [[nodiscard]] Eigen::Vector3f wayOf(std::uint32_t vertex, std::size_t way) const {
        return m_ends[way][vertex] - m_before[vertex];
    }

    const BallTree* m_tree;
    std::span<const Eigen::Vector3f> m_before;
    std::array<std::span<const Eigen::Vector3f>, 2> m_ends;
    std::uint32_t m_step = 0;
    std::vector<std::uint32_t> m_stamps;
    std::vector<LeafWay> m_ways;
};

/// May triangles of the two leaves come within `reach` on this way?
[[nodiscard]] bool mayMeet(const LeafWay& a, const LeafWay& b, std::size_t way, float reach);

}  // namespace grapeshot::detail
