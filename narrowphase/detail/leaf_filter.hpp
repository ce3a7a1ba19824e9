// Which leaf pairs can hold contacts: sixteen at a time, before anything is done for them one by one.
//
// This work is based on:
// David Johnson, Elaine Cohen. Spatialized Normal Cone Hierarchies. I3D 2001 (at a local minimum of the distance the
// normals face each other, and the line between the two points lies within the normal cones of both)
//
// The cones hold the surroundings of leaves, not of nodes: patches near each other are small, and larger nodes there
// are rarely parted by them.
#pragma once

#include <cstdint>
#include <span>

#include <grapeshot/adb/query.hpp>
#include <grapeshot/core/pose.hpp>
#include <grapeshot/narrowphase/mesh_model.hpp>

namespace grapeshot::detail {

/// Bit i stands for pair i.
struct LeafMasks {
    std::uint32_t within = 0;       ///< the boxes are within reach of each other
    std::uint32_t overlapping = 0;  ///< they overlap: the triangles may cut each other
    /// The leaves may touch: the surfaces face each other, and (unless the boxes overlap) some line between the two
    /// lies in the cones of both. Only of those within reach.
    std::uint32_t touching = 0;
};

class LeafFilter {
  public:
    static constexpr std::size_t width = 16;

    LeafFilter() = default;
    /// Refers to the models. `lean` as LocalContactSettings::lean; `reach`: contacts farther apart are left out, m.
    LeafFilter(const MeshModel& a, const MeshModel& b, const Pose& bInA, float lean, float reach);

    /// Up to `width` pairs. No work: it costs less than the traversal that found them.
    [[nodiscard]] LeafMasks operator()(std::span<const LeafPair> pairs) const noexcept;

  private:
    const MeshModel* m_a = nullptr;
    const MeshModel* m_b = nullptr;
    Pose m_bInA;
    float m_reach = 0, m_rounding = 0;  // m; the first holds the second
    NormalCone m_more;                  // what a lean beyond the usual adds to the cones of two leaves
    NormalCone m_wider;                 // what one has to be widened by, at an unusual lean
    bool m_usual = true;                // leans are no more than usualLean
    bool m_twoSided = false;            // a sheet has two sides
};

}  // namespace grapeshot::detail
