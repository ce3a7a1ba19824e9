// Discretely oriented polytope: K half-spaces in K/2 fixed directions. The DOP-tree is what the paper measures against.
//
// This work is based on:
// Gabriel Zachmann. Rapid Collision Detection by Dynamically Aligned DOP-Trees. VRAIS 1998 (B's DOP is enclosed by one
// in A's directions: each new slab is a fixed combination of three old ones, found once per pose)
#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>
#include <span>

#include <grapeshot/adb/reference/box.hpp>
#include <grapeshot/adb/reference/dop_directions.hpp>
#include <grapeshot/adb/reference/placement.hpp>

namespace grapeshot::reference {

template <int K>
struct Dop {
    static_assert(K == 18 || K == 26);
    static constexpr int axes = K / 2;
    std::array<double, axes> low;  ///< along dopDirections()[axis], m; the first three are x, y, z
    std::array<double, axes> high;

    Dop() {
        low.fill(std::numeric_limits<double>::infinity());
        high.fill(-std::numeric_limits<double>::infinity());
    }
    [[nodiscard]] static Dop around(std::span<const Eigen::Vector3d> points) {
        Dop dop;
        for (const Eigen::Vector3d& point : points) {
            for (int axis = 0; axis < axes; ++axis) {
                const double place = dopDirections()[axis].dot(point);
                dop.low[axis] = std::min(dop.low[axis], place);
                dop.high[axis] = std::max(dop.high[axis], place);
            }
        }
        return dop;
    }
    void inflate(double by) {
        for (int axis = 0; axis < axes; ++axis) {
            low[axis] -= by;
            high[axis] += by;
        }
    }
    [[nodiscard]] Box box() const { return {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}}; }
    [[nodiscard]] Eigen::Vector3d center() const { return box().center(); }

    class PairTest {
      public:
        explicit PairTest(const Placement& placement) {
            for (int axis = 0; axis < axes; ++axis) {
                const Eigen::Vector3d direction = dopDirections()[axis];
                // direction . (R x + t) = (R^T direction) . x + direction . t
                m_cones[axis] = dopCone(K, placement.rotation.transpose() * direction);
                m_shift[axis] = direction.dot(placement.translation);
            }
        }
        [[nodiscard]] bool disjoint(const Dop& a, const Dop& b) const {
            for (int axis = 0; axis < axes; ++axis) {
                const DopCone& cone = m_cones[axis];
                double highB = m_shift[axis];
                double lowB = m_shift[axis];
                for (int i = 0; i < 3; ++i) {
                    const int of = cone.axis[i];
                    const double weight = cone.weight[i];
                    highB += weight * (weight > 0 ? b.high[of] : b.low[of]);
                    lowB += weight * (weight > 0 ? b.low[of] : b.high[of]);
                }
                if (highB < a.low[axis] || lowB > a.high[axis]) {
                    return true;
                }
            }
            return false;
        }

      private:
        std::array<DopCone, axes> m_cones;
        std::array<double, axes> m_shift;
    };
};

}  // namespace grapeshot::reference
