// How a surface fills the cells of a regular grid over a box.
//
// This work is based on:
// Jan Klein, Gabriel Zachmann. ADB-Trees: Controlling the Error of Time-Critical Collision Detection. VMV 2003
// Gabriel Zachmann. Collision Detection as a Fundamental Technology in VR Based Product Engineering. 2007, section 6.2
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include <grapeshot/adb/reference/box.hpp>

namespace grapeshot::reference {

/// MaxArea(c): area of the largest polygon that fits into a box, longest side times diagonal of the other two. m^2
[[nodiscard]] double maxArea(const Eigen::Vector3d& sides);

/// Area_c: for each of the cells of a box how much surface lies in it.
class GridAreas {
  public:
    /// grid^3 cells of equal size.
    GridAreas(const Box& box, int grid);
    void add(const std::array<Eigen::Vector3d, 3>& triangle);
    /// m^2, x fastest.
    [[nodiscard]] const std::vector<double>& areas() const { return m_areas; }
    /// Definition 1, with the "suitably chosen MaxArea" as a factor: cells with Area_c >= tau * MaxArea(c).
    [[nodiscard]] int wellFilled(double tau) const;

  private:
    struct Range {
        int first;
        int last;
    };
    [[nodiscard]] Range cellsAlong(int axis, const std::array<Eigen::Vector3d, 3>& triangle) const;
    /// The plane below cell `index`.
    [[nodiscard]] double plane(int axis, int index) const;

    Box m_box;
    int m_grid;
    std::vector<double> m_areas;
};

}  // namespace grapeshot::reference
