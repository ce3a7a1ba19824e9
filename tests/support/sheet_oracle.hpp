// The slow truth of sides: what of a surface lies straight above and below a point. In double precision, by a count of
// crossings that gives every point of the plan to one triangle alone, also on shared edges.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include <grapeshot/core/mesh_view.hpp>

namespace grapeshot::test {

/// Triangles that a vertical line (y) through a point crosses. One within 1e-12 m of the point counts as below it.
struct Crossings {
    int above = 0;
    int below = 0;
};

class VerticalOracle {
  public:
    /// Keeps both spans. Time and memory: one cell of a grid of about as many cells as triangles for each that a
    /// triangle's plan touches.
    VerticalOracle(std::span<const Eigen::Vector3d> vertices, std::span<const Triangle> triangles);

    [[nodiscard]] Crossings at(const Eigen::Vector3d& point) const;

  private:
    [[nodiscard]] int cellOf(double value, int axis) const;

    std::span<const Eigen::Vector3d> m_vertices;
    std::span<const Triangle> m_triangles;
    int m_side = 1;  // cells along x and z
    Eigen::Vector3d m_lower = Eigen::Vector3d::Zero();
    Eigen::Vector3d m_upper = Eigen::Vector3d::Zero();
    std::vector<std::uint32_t> m_begin;  // of each cell's part of m_inCells
    std::vector<std::uint32_t> m_inCells;
};

/// Points that have passed a sheet they were all above of: an odd number of crossings above. So folds of the sheet
/// over a point do not count.
[[nodiscard]] int pointsBelow(const VerticalOracle& sheet, std::span<const Eigen::Vector3d> points);
/// The same of points they were all below of.
[[nodiscard]] int pointsAbove(const VerticalOracle& sheet, std::span<const Eigen::Vector3d> points);

}  // namespace grapeshot::test
