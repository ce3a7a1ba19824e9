// A pair goes downhill: to closer neighbours, and to finer levels where it is near.
//
// This work is based on:
// Stephane Guy, Gilles Debunne. Monte-Carlo Collision Detection. INRIA RR-5136, 2004 (neighbours x neighbours, levels)
// Laks Raghupathi et al. An Intestinal Surgery Simulator. TVCG 10(6), 2004 (one end at a time)
#pragma once

#include <cstddef>
#include <cstdint>

#include <grapeshot/scf/reference/detail/placed_surface.hpp>
#include <grapeshot/scf/reference/settings.hpp>

namespace grapeshot::scf::reference::detail {

struct FeaturePair {
    std::uint32_t a = 0;
    std::uint32_t b = 0;
    /// Of both ends: levels are counted from the finest; a surface with fewer stays at its coarsest.
    std::uint8_t level = 0;
};

struct SearchWork {
    std::size_t distances = 0;  ///< between two features
    std::size_t moves = 0;
};

class LocalSearch {
  public:
    LocalSearch(const PlacedSurface& a, const PlacedSurface& b, const Settings& settings)
        : m_a(a), m_b(b), m_settings(settings) {}

    /// To a local minimum of the distance of centres, or as far as `mostMoves` goes.
    void descend(FeaturePair& pair, SearchWork& work) const;

    /// Distance of the balls, m; not below 0.
    [[nodiscard]] float gap(const FeaturePair& pair) const;
    [[nodiscard]] std::uint8_t coarsestLevel() const;

  private:
    [[nodiscard]] std::size_t levelOfA(int level) const;
    [[nodiscard]] std::size_t levelOfB(int level) const;
    [[nodiscard]] float distance2(const FeaturePair& pair) const;
    [[nodiscard]] float radii(const FeaturePair& pair) const;
    [[nodiscard]] bool move(FeaturePair& pair, SearchWork& work) const;
    [[nodiscard]] bool moveFully(FeaturePair& pair, SearchWork& work) const;
    [[nodiscard]] bool moveOneByOne(FeaturePair& pair, SearchWork& work) const;
    [[nodiscard]] FeaturePair parents(const FeaturePair& pair) const;
    [[nodiscard]] FeaturePair closestChildren(const FeaturePair& pair, SearchWork& work) const;

    const PlacedSurface& m_a;
    const PlacedSurface& m_b;
    const Settings& m_settings;
};

}  // namespace grapeshot::scf::reference::detail
