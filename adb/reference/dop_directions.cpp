#include <grapeshot/adb/reference/dop_directions.hpp>

#include <Eigen/LU>
#include <limits>
#include <vector>

namespace grapeshot::reference {

namespace {

/// A face of the convex hull of the unit directions and their opposites: a cone with nothing inside.
struct HullFace {
    std::array<int, 3> axis;
    std::array<double, 3> sign;
    Eigen::Matrix3d toWeights;  ///< inverse of the three directions as columns
};

Eigen::Vector3d signedDirection(int index) {
    return (index % 2 == 0 ? 1.0 : -1.0) * dopDirections()[static_cast<std::size_t>(index / 2)];
}

std::vector<HullFace> hullFaces(int k) {
    std::vector<HullFace> faces;
    for (int a = 0; a < k; ++a) {
        for (int b = a + 1; b < k; ++b) {
            for (int c = b + 1; c < k; ++c) {
                Eigen::Matrix3d corners;
                corners << signedDirection(a), signedDirection(b), signedDirection(c);
                if (std::abs(corners.determinant()) < 1e-9) {
                    continue;  // a plane through the origin
                }
                const Eigen::Matrix3d inverse = corners.inverse();
                // The plane through the corners: sum of the weights is 1. No other direction may be beyond it.
                const Eigen::RowVector3d plane = inverse.colwise().sum();
                bool outermost = true;
                for (int other = 0; other < k && outermost; ++other) {
                    outermost = plane.dot(signedDirection(other)) < 1 + 1e-9;
                }
                if (outermost) {
                    faces.push_back({{a / 2, b / 2, c / 2},
                                     {a % 2 == 0 ? 1.0 : -1.0, b % 2 == 0 ? 1.0 : -1.0, c % 2 == 0 ? 1.0 : -1.0},
                                     inverse});
                }
            }
        }
    }
    return faces;
}

}  // namespace

const std::array<Eigen::Vector3d, 13>& dopDirections() {
    static const std::array<Eigen::Vector3d, 13> directions = [] {
        std::array<Eigen::Vector3d, 13> all{Eigen::Vector3d(1, 0, 0),
                                            {0, 1, 0},
                                            {0, 0, 1},
                                            {1, 1, 0},
                                            {1, -1, 0},
                                            {1, 0, 1},
                                            {1, 0, -1},
                                            {0, 1, 1},
                                            {0, 1, -1},
                                            {1, 1, 1},
                                            {1, 1, -1},
                                            {1, -1, 1},
                                            {1, -1, -1}};
        for (Eigen::Vector3d& direction : all) {
            direction.normalize();
        }
        return all;
    }();
    return directions;
}

DopCone dopCone(int k, const Eigen::Vector3d& direction) {
    static const std::vector<HullFace> faces18 = hullFaces(18);
    static const std::vector<HullFace> faces26 = hullFaces(26);
    DopCone cone{};
    double best = -std::numeric_limits<double>::infinity();
    for (const HullFace& face : k == 18 ? faces18 : faces26) {
        const Eigen::Vector3d weights = face.toWeights * direction;
        // On a border of two cones rounding may leave both with a weight of -1e-17: any of them is exact there.
        if (weights.minCoeff() > best) {
            best = weights.minCoeff();
            for (std::size_t i = 0; i < 3; ++i) {
                cone.axis[i] = face.axis[i];
                cone.weight[i] = face.sign[i] * weights[static_cast<Eigen::Index>(i)];
            }
            if (best >= 0) {
                break;
            }
        }
    }
    return cone;
}

}  // namespace grapeshot::reference
