// The regions of contact of a frame, how old they are, and how much of them a report covers.
#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include <grapeshot/scf/tracker.hpp>

namespace grapeshot::bench {

/// Share of the true contacts with a reported one within `radius`, middles between the witness points; 1 if there are
/// none.
[[nodiscard]] double coverage(std::span<const TrackedContact> truth, std::span<const TrackedContact> reported,
                              float radius);

/// Regions: contacts that share a vertex on both surfaces, and so on. One that comes within `spacing` of a region of
/// the frame before goes on with its age; else it is new, of age 1.
class RegionHistory {
  public:
    explicit RegionHistory(float spacing) : m_spacing(spacing) {}

    /// The next frame.
    void advance(std::span<const TrackedContact> truth, const Surface& a, const Surface& b);
    [[nodiscard]] std::size_t count() const { return m_ages.size(); }
    /// Age of every region of this frame.
    [[nodiscard]] const std::vector<int>& ages() const { return m_ages; }
    /// Per region: is a pair of triangles of it reported?
    [[nodiscard]] std::vector<bool> found(std::span<const TrackedContact> reported) const;

  private:
    float m_spacing;
    std::vector<int> m_ages;
    std::unordered_map<std::uint64_t, std::uint32_t> m_regionOfPair;
    std::unordered_map<std::uint64_t, int> m_agesBefore;  ///< by place, of the frame before
};

}  // namespace grapeshot::bench
