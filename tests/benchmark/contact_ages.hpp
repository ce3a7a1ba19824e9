// Which regions of contact there really are in each step, and since when.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include <grapeshot/adb/query.hpp>
#include <grapeshot/adb/tree.hpp>
#include <grapeshot/core/topology.hpp>

namespace grapeshot::bench {

/// The exact triangle pairs within a distance, in regions.
struct TrueRegions {
    std::map<TrianglePair, std::size_t> regionOf;
    std::vector<int> ages;  ///< per region: 1 in the step in which it appears
};

/// Follows two surfaces that move from step to step. A region is what hangs together by pairs and by shared vertices
/// of either surface; it is as old as the oldest region of the step before with which it shares, within one edge,
/// vertices of both surfaces, and a step.
class ContactAges {
  public:
    /// @throws Error as `build` does
    ContactAges(MeshView a, MeshView b, float maxDistance);

    /// Exact, by refitted trees. @throws Error as `refit` does
    TrueRegions next(std::span<const Eigen::Vector3f> a, std::span<const Eigen::Vector3f> b);

  private:
    /// Of a region: welded vertices of one body, ascending.
    using Vertices = std::vector<std::uint32_t>;
    struct Region {
        Vertices a, b;
        int age = 1;
    };
    [[nodiscard]] int ageOf(const Region& region) const;

    Tree m_treeA, m_treeB;
    Topology m_topologyA, m_topologyB;
    float m_maxDistance;
    std::vector<Region> m_before;  ///< grown by one ring
};

}  // namespace grapeshot::bench
