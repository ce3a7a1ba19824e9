// Distances along the edges of a surface at rest.
//
// This work is based on:
// Ulrich Meyer, Peter Sanders. Delta-stepping: a parallelizable shortest path algorithm. Journal of Algorithms 49, 2003
// (buckets in place of a heap; here one after the other)
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <grapeshot/core/sliced.hpp>
#include <grapeshot/scf/surface.hpp>

namespace grapeshot::detail {

/// Shortest paths from one vertex after another; memory is kept between searches. Everything long is in slices.
class Geodesics {
  public:
    /// Of no use before `prepare` is through.
    explicit Geodesics(const Surface& surface) : m_surface(surface) {}
    Sliced prepare();

    /// The vertices that the next searches are about. Distinct.
    Sliced setGoals(std::span<const std::uint32_t> vertices);
    /// Distances within the goals alone, in the order of the goals, m. Not connected if the goals are not among
    /// themselves: each further part then begins at the largest distance so far, from its first goal on.
    Sliced withinGoals(std::uint32_t from, std::vector<double>& distances, bool& connected);
    /// Largest distance to a goal along any path on the surface, m; infinite if one cannot be reached.
    [[nodiscard]] double radiusAround(std::uint32_t center);
    /// An upper bound of it, from a search that does not go far beyond the goals; infinite if that reaches not all.
    Sliced radiusNear(std::uint32_t center, double& radius);

  private:
    struct Label {
        double distance = 0;
        std::uint32_t search = 0;  ///< in which it was reached
        std::uint32_t goal = 0;    ///< of which goals
    };
    struct Entry {
        double distance;
        std::uint32_t vertex;
    };
    void reach(std::uint32_t vertex, double distance);
    [[nodiscard]] std::uint64_t bucketOf(double distance) const;
    /// Until there is nothing left to reach, or so many were visited.
    Sliced run(bool goalsOnly, std::size_t mostVisits);
    void clear();
    [[nodiscard]] double largestDistance() const;

    const Surface& m_surface;
    double m_width = 1;  ///< of a bucket, m
    std::vector<Label> m_labels;
    std::vector<std::uint32_t> m_goalList;
    std::uint32_t m_search = 0, m_goals = 0;
    std::array<std::vector<Entry>, 64> m_buckets;  ///< by distance, turning
    std::size_t m_queued = 0;
    std::uint64_t m_current = 0;
};

}  // namespace grapeshot::detail
