// Surfaces of solids made of the cells of a bent lattice.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include <scenes/shapes.hpp>

namespace grapeshot::scenes::detail {

/// Ascending values, each interval between neighbours cut into `cells` equal parts.
std::vector<double> refined(const std::vector<double>& values, int cells);

/// What a lattice is filled with and how it is bent. Coordinates are those of the three axes below; `position` must
/// keep orientation (positive Jacobian), `filled` is asked for the middle of a cell. Two filled cells must not touch in
/// an edge or a corner alone, or the surface is not manifold.
struct Lattice {
    std::vector<double> x, y, z;
    std::function<bool(const Eigen::Vector3d&)> filled = [](const Eigen::Vector3d&) { return true; };
    std::function<Eigen::Vector3d(const Eigen::Vector3d&)> position = [](const Eigen::Vector3d& p) { return p; };
};

/// The boundary of the filled cells: two triangles per cell face, welded, outward.
Mesh boundary(const Lattice& lattice);

}  // namespace grapeshot::scenes::detail
