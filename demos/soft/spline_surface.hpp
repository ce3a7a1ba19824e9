// Smooth fine grids over coarse ones: biquadratic B-splines, each vertex a mean of nine nodes.
#pragma once

#include <array>
#include <cstdint>
#include <utility>

#include "contact_projection.hpp"

namespace grapeshot::soft {

/// Node indices and weights in one direction of a grid, for a place in cells.
struct SplineRow {
    std::array<int, 3> index{};
    std::array<double, 3> weight{};
};
/// @param count of the nodes in that direction; what lies beyond an end is that end, or with `closed` the other one
[[nodiscard]] SplineRow splineRow(double place, int count, bool closed);

/// Appends a vertex. @param nodeAt the node of a place in the grid
template <class NodeAt>
std::uint32_t addVertex(CarriedSurface& surface, const SplineRow& u, const SplineRow& v, const NodeAt& nodeAt) {
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            const double weight = u.weight[i] * v.weight[k];
            if (weight > 0) {
                surface.shares.push_back(
                    {static_cast<std::uint32_t>(nodeAt(u.index[i], v.index[k])), static_cast<float>(weight)});
            }
        }
    }
    surface.ends.push_back(static_cast<std::uint32_t>(surface.shares.size()));
    return surface.vertices() - 1;
}

}  // namespace grapeshot::soft
