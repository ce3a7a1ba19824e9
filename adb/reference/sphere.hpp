// Ball about the middle of the box: the lightest node that the paper names (Hubbard's spheres).
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <span>

#include <grapeshot/adb/reference/box.hpp>
#include <grapeshot/adb/reference/placement.hpp>

namespace grapeshot::reference {

struct Sphere {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    double radius = 0;

    [[nodiscard]] static Sphere around(std::span<const Eigen::Vector3d> points) {
        Sphere sphere;
        sphere.middle = Box::around(points).center();
        double squared = 0;
        for (const Eigen::Vector3d& point : points) {
            squared = std::max(squared, (point - sphere.middle).squaredNorm());
        }
        sphere.radius = std::sqrt(squared);
        return sphere;
    }
    void inflate(double by) { radius += by; }
    [[nodiscard]] Eigen::Vector3d center() const { return middle; }
    /// The cube around it: the paper asks for a grid of cuboids, whatever the volume.
    [[nodiscard]] Box box() const {
        const Eigen::Vector3d half = Eigen::Vector3d::Constant(radius);
        return {middle - half, middle + half};
    }

    class PairTest {
      public:
        explicit PairTest(const Placement& placement) : m_placement(placement) {}
        [[nodiscard]] bool disjoint(const Sphere& a, const Sphere& b) const {
            const double reach = a.radius + m_placement.stretch * b.radius;
            return (m_placement.toA(b.middle) - a.middle).squaredNorm() > reach * reach;
        }

      private:
        Placement m_placement;
    };
};

}  // namespace grapeshot::reference
