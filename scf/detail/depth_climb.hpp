// From vertices behind another surface to the deepest one that neighbours lead to.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <grapeshot/scf/detail/meter.hpp>
#include <grapeshot/scf/detail/surface_probe.hpp>

namespace grapeshot::detail {

struct ClimbStart {
    std::uint32_t vertex = 0;
    std::uint32_t triangle = 0;  ///< of the other surface, near it
    int side = 1;                ///< of the other surface on which the vertex belongs
};

struct Summit {
    std::uint32_t vertex = 0;  ///< welded
    Foot foot;
    int side = 1;
    bool isChecked = false;
};

class DepthClimb {
  public:
    /// The deepest vertices first, as long as they get deeper, and a little on. Nothing if none of the starts is behind
    /// the surface.
    /// @param check search the whole surface for the summit's foot. If it is another, climb again and search it for
    /// every vertex that is passed
    std::optional<Summit> climb(const SurfaceProbe& from, SurfaceProbe& onto, std::span<const ClimbStart> starts,
                                bool check, Meter& meter, std::uint64_t& work);

  private:
    struct Visit {
        double depth = 0;  ///< m, an upper bound unless exact
        std::uint32_t vertex = 0;
        std::uint32_t triangle = 0;
        int side = 1;
        bool isExact = false;
        friend bool operator<(const Visit& x, const Visit& y) {
            return x.depth != y.depth ? x.depth < y.depth : x.vertex > y.vertex;
        }
    };
    void visit(const SurfaceProbe& from, const SurfaceProbe& onto, const ClimbStart& start, std::uint64_t& work);
    void put(const Visit& visit);
    /// Makes its depth exact. False: it is not behind the surface.
    [[nodiscard]] static bool settle(const SurfaceProbe& from, SurfaceProbe& onto, Visit& visit, std::uint64_t& work);
    [[nodiscard]] std::optional<Visit> ascend(const SurfaceProbe& from, SurfaceProbe& onto, bool exactly, Meter& meter,
                                              std::uint64_t& work);
    void begin(std::size_t vertices);

    std::vector<Visit> m_heap;
    std::vector<std::uint32_t> m_seen;  ///< per vertex: in which round
    std::uint32_t m_round = 0;
};

}  // namespace grapeshot::detail
