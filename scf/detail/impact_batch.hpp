// Sixteen pairs of moving triangles, each at its own time, that are led towards their impacts.
#pragma once

#include <cstdint>

#include <grapeshot/scf/continuous.hpp>
#include <grapeshot/scf/detail/advance_kernels.hpp>
#include <grapeshot/scf/detail/impact_space.hpp>

namespace grapeshot::detail {

/// A pair of triangles by leaf and lane: 16 leaf + lane.
struct LanePair {
    std::uint32_t a = 0;
    std::uint32_t b = 0;
};

class ImpactBatch {
  public:
    /// @param count how many are in `pairs`, 1..16
    void load(const ImpactSpace& space, const LanePair* pairs, int count);
    /// One unit. Returns the lanes that touch at their time; step: so long the others do not.
    std::uint32_t run(const ImpactSpace& space, const float (&time)[16], float (&step)[16]);
    /// What the last run says of a lane that touches.
    [[nodiscard]] Impact impactOf(const ImpactSpace& space, int lane, float time) const;
    [[nodiscard]] const DistanceBatch& out() const { return m_out; }
    [[nodiscard]] TrianglePair triangles(const ImpactSpace& space, int lane) const;

  private:
    void placeTurning(const ImpactSpace& space, const float (&time)[16]);

    PathBatch m_path;
    MovingBatch m_moving;
    DistanceBatch m_out{};
    LanePair m_pairs[16];
    Eigen::Vector3d m_origin[16];  ///< A's first corner, of those that turn
    int m_count = 0;
};

}  // namespace grapeshot::detail
