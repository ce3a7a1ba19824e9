// Which features of two leaves may touch: the wide filter before the tests one by one.
//
// This work is based on:
// Ming Lin, John Canny. A fast algorithm for incremental distance calculation. ICRA 1991 (Voronoi regions)
// Dirk Gregorius. The Separating Axis Test between Convex Polyhedra. GDC 2013 (edges touch only where their arcs on the
// Gauss map cross)
//
// Distances and directions in single precision with a slack for all rounding, so that nothing is left out that the
// exact tests (feature_contacts.hpp) would take.
#pragma once

#include <cstdint>

#include <grapeshot/narrowphase/detail/placed_leaf.hpp>

namespace grapeshot::detail {

struct FeatureLimits {
    float maxDistance = 0;  ///< m, infinity allowed
    float rounding = 0;     ///< of coordinates, m
    float lean = 0;         ///< as LocalContactSettings::lean
    bool solidA = false, solidB = false;
    bool contacts = true;  ///< look for features that may touch
    bool overlaps = true;  ///< look for triangles that may cut each other
};

/// Bit 4 a + b stands for triangle a of A's leaf and b of B's. `any` is the union of all but `overlapping`.
struct FeatureMasks {
    std::uint32_t any = 0;
    std::uint32_t overlapping = 0;       ///< the triangles may cut each other
    std::uint32_t cornerBFaceA[3] = {};  ///< [corner of B]
    std::uint32_t cornerAFaceB[3] = {};
    std::uint32_t edges[3][3] = {};         ///< [edge of A][edge of B]
    std::uint32_t cornerBEdgeA[3][3] = {};  ///< [corner of B][edge of A]
    std::uint32_t cornerAEdgeB[3][3] = {};
    std::uint32_t corners[3][3] = {};  ///< [corner of A][corner of B]
};

/// One work unit. Everything but `any` and `overlapping` is only set if `any` is not zero.
void filterFeatures(const LeafRows& a, const LeafRows& b, const FeatureLimits& limits, FeatureMasks& out) noexcept;

}  // namespace grapeshot::detail
