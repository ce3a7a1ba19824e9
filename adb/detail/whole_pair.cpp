#include <grapeshot/adb/detail/whole_pair.hpp>

#include <algorithm>
#include <cstring>
#include <limits>

namespace grapeshot::detail {
namespace {

using Four = float __attribute__((vector_size(16)));

Four four(const float* p) {
    Four out;
    std::memcpy(&out, p, sizeof(out));
    return out;
}
/// Of the first three.
Four cross(Four a, Four b) {
    const Four nextA = __builtin_shufflevector(a, a, 1, 2, 0, 3);
    const Four nextB = __builtin_shufflevector(b, b, 1, 2, 0, 3);
    const Four turned = a * nextB - nextA * b;
    return __builtin_shufflevector(turned, turned, 1, 2, 0, 3);
}
float dot(Four a, Four b) {
    const Four products = a * b;
    return products[0] + products[1] + products[2];
}

/// Less would be rounding: the determinant of a unit's cube is one.
constexpr float leastDeterminant = 1e-24F;

}  // namespace

float squaredDistanceOfWholes(const WholeSurface& a, const WholeSurface& b, const PairPose& pose) noexcept {
    const float unit = std::max(a.unit, b.unit);
    const float partA = a.unit / unit;  // powers of two
    const float partB = b.unit / unit;
    const float squareA = partA * partA;
    const float squareB = partB * partB;
    const Four x = four(pose.row[0]);
    const Four y = four(pose.row[1]);
    const Four z = four(pose.row[2]);
    const Four column0 = {x[0], y[0], z[0], 0};
    const Four column1 = {x[1], y[1], z[1], 0};
    const Four column2 = {x[2], y[2], z[2], 0};
    const Four shift = {x[3], y[3], z[3], 0};
    const auto turned = [&](Four v) { return v[0] * column0 + v[1] * column1 + v[2] * column2; };
    // R S R^T: the rows of R S are those of R turned by the symmetric S.
    const Four s0 = four(b.covariance[0]);
    const Four s1 = four(b.covariance[1]);
    const Four s2 = four(b.covariance[2]);
    const auto row = [&](Four r, const float* own) {
        return four(own) * squareA + turned(r[0] * s0 + r[1] * s1 + r[2] * s2) * squareB;
    };
    const Four sum0 = row(x, a.covariance[0]);
    const Four sum1 = row(y, a.covariance[1]);
    const Four sum2 = row(z, a.covariance[2]);
    const Four d = (turned(four(b.mean)) + shift - four(a.mean)) / unit;
    const Four cofactor0 = cross(sum1, sum2);
    const Four cofactor1 = cross(sum2, sum0);
    const Four cofactor2 = cross(sum0, sum1);
    const float determinant = dot(sum0, cofactor0);
    const float product = dot(d, d[0] * cofactor0 + d[1] * cofactor1 + d[2] * cofactor2);
    return determinant > leastDeterminant ? product / determinant : std::numeric_limits<float>::quiet_NaN();
}

}  // namespace grapeshot::detail
