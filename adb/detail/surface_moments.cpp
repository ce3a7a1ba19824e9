#include <grapeshot/adb/detail/surface_moments.hpp>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace grapeshot::detail {
namespace {

constexpr int rows[6] = {0, 1, 1, 2, 2, 2};
constexpr int columns[6] = {0, 0, 1, 0, 1, 2};
constexpr double leastOctaves = -120;

std::int8_t signedByte(double value) {
    return static_cast<std::int8_t>(std::lround(std::clamp(value, -1.0, 1.0) * 127));
}

/// Lower root of a matrix that may be singular, or a little less than that by rounding.
Eigen::Matrix3d rootOf(const Eigen::Matrix3d& covariance) {
    Eigen::Matrix3d root = Eigen::Matrix3d::Zero();
    for (int column = 0; column < 3; ++column) {
        for (int row = column; row < 3; ++row) {
            double rest = covariance(row, column);
            for (int k = 0; k < column; ++k) {
                rest -= root(row, k) * root(column, k);
            }
            if (row == column) {
                root(row, row) = std::sqrt(std::max(rest, 0.0));
            } else if (root(column, column) > 1e-6) {
                root(row, column) = rest / root(column, column);
            }
        }
    }
    return root;
}

}  // namespace

SurfaceMoments momentsOf(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
    SurfaceMoments out;
    out.normalSum = 0.5 * (b - a).cross(c - a);
    out.area = out.normalSum.norm();
    out.mean = (a + b + c) / 3.0;
    // The second moment of a uniform triangle is that of its corners with a twelfth of its area each.
    for (const Eigen::Vector3d* corner : {&a, &b, &c}) {
        const Eigen::Vector3d d = *corner - out.mean;
        out.covariance += d * d.transpose() / 12.0;
    }
    return out;
}

SurfaceMoments sum(const SurfaceMoments* pieces, int count) {
    SurfaceMoments out;
    for (int i = 0; i < count; ++i) {
        out.area += pieces[i].area;
        out.normalSum += pieces[i].normalSum;
    }
    const auto weight = [&](int i) { return out.area > 0 ? pieces[i].area / out.area : 1.0 / count; };
    // About the first piece: far from the origin the plain sum would lose what the covariance needs.
    for (int i = 1; i < count; ++i) {
        out.mean += weight(i) * (pieces[i].mean - pieces[0].mean);
    }
    out.mean += pieces[0].mean;
    for (int i = 0; i < count; ++i) {
        const Eigen::Vector3d d = pieces[i].mean - out.mean;
        out.covariance += weight(i) * (pieces[i].covariance + d * d.transpose());
    }
    return out;
}

void store(const SurfaceMoments& moments, const Node& node, int slot, NodeDistribution& out) {
    double size = 0;
    for (const auto& half : node.half) {
        size = std::max(size, double{half[slot]});
    }
    out.size[slot] = static_cast<float>(size);
    for (int axis = 0; axis < 3; ++axis) {
        out.mean[axis][slot] = signedByte((moments.mean[axis] - node.center[axis][slot]) / size);
    }
    // In units of the size, where nothing over- or underflows.
    const Eigen::Matrix3d covariance = moments.covariance / (size * size);
    const Eigen::Matrix3d root = rootOf(covariance + thickening * covariance.trace() * Eigen::Matrix3d::Identity());
    for (int entry = 0; entry < 6; ++entry) {
        out.root[entry][slot] = signedByte(root(rows[entry], columns[entry]));
    }
    for (const int entry : {0, 2, 5}) {  // a point, say: not zero, for the sake of the inverse
        out.root[entry][slot] = std::max(out.root[entry][slot], std::int8_t{1});
    }
    const double flatness = moments.area > 0 ? moments.normalSum.norm() / moments.area : 0;
    out.flatness[slot] = static_cast<std::uint8_t>(std::lround(std::clamp(flatness, 0.0, 1.0) * 255));
    const double octaves = moments.area > 0 ? std::log2(moments.area) : leastOctaves;
    out.area[slot] = static_cast<std::int16_t>(std::lround(256 * std::clamp(octaves, leastOctaves, 120.0)));
}

void storeWhole(const SurfaceMoments& moments, double halfDiagonal, WholeSurface& out) {
    out = WholeSurface();
    out.unit = static_cast<float>(std::exp2(std::round(std::log2(std::clamp(halfDiagonal, 1e-30, 1e30)))));
    const double unit = out.unit;
    const Eigen::Matrix3d covariance =
        (moments.covariance + thickening * moments.covariance.trace() * Eigen::Matrix3d::Identity()) / (unit * unit);
    for (int axis = 0; axis < 3; ++axis) {
        out.mean[axis] = static_cast<float>(moments.mean[axis]);
        for (int other = 0; other < 3; ++other) {
            out.covariance[axis][other] = static_cast<float>(covariance(other, axis));
        }
    }
}

void storeNone(int slot, NodeDistribution& out) {
    out.size[slot] = 1;
    for (auto& row : out.mean) {
        row[slot] = 0;
    }
    for (auto& row : out.root) {
        row[slot] = 1;
    }
    out.flatness[slot] = 0;
    out.area[slot] = static_cast<std::int16_t>(256 * leastOctaves);
}

}  // namespace grapeshot::detail

namespace grapeshot {

ChildSurface surfaceOf(const Node& node, const NodeDistribution& distribution, int slot) noexcept {
    const double unit = double{distribution.size[slot]} / 127;
    ChildSurface out;
    const double octaves = distribution.area[slot] / 256.0;
    out.area = octaves < -100 ? 0 : std::exp2(octaves);
    for (int axis = 0; axis < 3; ++axis) {
        out.mean[axis] = node.center[axis][slot] + unit * distribution.mean[axis][slot];
    }
    Eigen::Matrix3d root = Eigen::Matrix3d::Zero();
    for (int entry = 0; entry < 6; ++entry) {
        root(detail::rows[entry], detail::columns[entry]) = unit * distribution.root[entry][slot];
    }
    out.covariance = root * root.transpose();
    out.flatness = distribution.flatness[slot] / 255.0;
    return out;
}

}  // namespace grapeshot
