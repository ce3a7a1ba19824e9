// Axis-aligned box: the bounding volume of the paper's experiments, and the frame of the grid for every other one.
//
// This work is based on:
// Gabriel Zachmann. Minimal Hierarchical Collision Detection. VRST 2002 (the lite separating-axis test: faces only)
#pragma once

#include <Eigen/Core>
#include <limits>
#include <span>

#include <grapeshot/adb/reference/placement.hpp>

namespace grapeshot::reference {

struct Box {
    Eigen::Vector3d lower = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
    Eigen::Vector3d upper = Eigen::Vector3d::Constant(-std::numeric_limits<double>::infinity());

    [[nodiscard]] static Box around(std::span<const Eigen::Vector3d> points) {
        Box box;
        for (const Eigen::Vector3d& point : points) {
            box.grow(point);
        }
        return box;
    }
    void grow(const Eigen::Vector3d& point) {
        lower = lower.cwiseMin(point);
        upper = upper.cwiseMax(point);
    }
    void grow(const Box& other) {
        lower = lower.cwiseMin(other.lower);
        upper = upper.cwiseMax(other.upper);
    }
    void inflate(double by) {
        lower.array() -= by;
        upper.array() += by;
    }
    [[nodiscard]] Eigen::Vector3d sides() const { return upper - lower; }
    [[nodiscard]] Eigen::Vector3d center() const { return 0.5 * (lower + upper); }
    [[nodiscard]] const Box& box() const { return *this; }
    [[nodiscard]] bool touches(const Box& other) const {
        return (lower.array() <= other.upper.array()).all() && (other.lower.array() <= upper.array()).all();
    }

    /// Six of the fifteen axes: the faces of both boxes. What it calls disjoint is disjoint; nearly disjoint pairs of
    /// edges it may leave.
    class PairTest {
      public:
        explicit PairTest(const Placement& placement)
            : m_placement(placement),
              m_magnitude(placement.rotation.cwiseAbs()),
              m_inverseMagnitude(placement.inverseRotation.cwiseAbs()) {}

        [[nodiscard]] bool disjoint(const Box& a, const Box& b) const {
            const Eigen::Vector3d halfA = 0.5 * a.sides();
            const Eigen::Vector3d halfB = 0.5 * b.sides();
            const Eigen::Vector3d apart = m_placement.toA(b.center()) - a.center();
            if ((apart.cwiseAbs() - halfA - m_magnitude * halfB).maxCoeff() > 0) {
                return true;
            }
            return ((m_placement.inverseRotation * apart).cwiseAbs() - halfB - m_inverseMagnitude * halfA).maxCoeff() >
                   0;
        }

      private:
        Placement m_placement;
        Eigen::Matrix3d m_magnitude;
        Eigen::Matrix3d m_inverseMagnitude;
    };
};

}  // namespace grapeshot::reference
