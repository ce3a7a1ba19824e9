#include <grapeshot/adb/detail/pair_pose.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

#include <grapeshot/adb/detail/tree_contents.hpp>

namespace grapeshot::detail {
namespace {

constexpr double rigidTolerance = 1e-3;  // as isRigid has it

/// The largest entry of |R^T R - I|; infinite if that is above the tolerance, not finite, or R a reflection.
double deviation(const float (&r)[3][3]) {
    double worst = 0;
    for (int i = 0; i < 3; ++i) {
        for (int j = i; j < 3; ++j) {
            const double product = double{r[0][i]} * r[0][j] + double{r[1][i]} * r[1][j] + double{r[2][i]} * r[2][j];
            const double off = std::abs(product - (i == j ? 1.0 : 0.0));
            if (!(off <= rigidTolerance)) {
                return std::numeric_limits<double>::infinity();
            }
            worst = std::max(worst, off);
        }
    }
    const double determinant = double{r[0][0]} * (double{r[1][1]} * r[2][2] - double{r[1][2]} * r[2][1]) -
                               double{r[0][1]} * (double{r[1][0]} * r[2][2] - double{r[1][2]} * r[2][0]) +
                               double{r[0][2]} * (double{r[1][0]} * r[2][1] - double{r[1][1]} * r[2][0]);
    return determinant > 0 ? worst : std::numeric_limits<double>::infinity();
}

/// Denormal operands would make the kernel ten times slower; the change is far below the slack.
float flushed(float value) {
    return std::abs(value) < 1e-30F ? 0.0F : value;
}

}  // namespace

PoseVerdict prepare(const Pose& bInA, float radiusA, float radiusB, float maxDistance, PairPose& out) noexcept {
    double squaredTranslation = 0;
    for (int row = 0; row < 3; ++row) {
        out.translation[row] = flushed(bInA.translation[row]);
        squaredTranslation += double{out.translation[row]} * out.translation[row];
        for (int column = 0; column < 3; ++column) {
            out.rotation[row][column] = flushed(bInA.rotation(row, column));
        }
    }
    const double skew = deviation(out.rotation);
    if (!std::isfinite(skew) || !std::isfinite(squaredTranslation)) {
        return PoseVerdict::invalid;
    }
    const double distance = std::min(maxDistance, maxInflation);  // infinity would make NaN of the products below
    const double reach = double{radiusA} + radiusB * (1 + 2 * skew);
    const double shift = std::sqrt(squaredTranslation);
    if (shift > (reach + distance) * (1 + 1e-6)) {
        return PoseVerdict::apart;
    }
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) {
            const float entry = out.rotation[row][column];
            const float mirrored = out.rotation[column][row];
            float* lanes = out.turn[row][column];
            std::fill(lanes, lanes + 4, std::abs(entry));
            std::fill(lanes + 4, lanes + 8, std::abs(mirrored));
            std::fill(lanes + 8, lanes + 12, entry);
            std::fill(lanes + 12, lanes + 16, mirrored);
        }
    }
    // Rounding. Centres and half extents are at most sqrt(3) radii long, so everything the kernel adds up stays below
    // S = 2 sqrt(3) (rA + rB) + |t|. The longest chain (box centre through R and R^T onto a slab's normal) makes fewer
    // than 32 roundings of at most S / 2^24 each. The tiny constant is for denormals, also where the host flushes them.
    constexpr double unit = 0x1p-24;
    const double magnitude = 3.5 * reach + shift;
    const double rounding = 32 * unit * magnitude + 1e-35;
    // With R^T R = I + E, B's own axes and slabs, measured by R^T for the inverse, are off by |E p| for p on B.
    const double crooked = 3 * skew * (double{radiusB} + distance);
    const double inflation = distance * (1 + 1e-6) + rounding + crooked;
    out.threshold = -static_cast<float>(std::min(inflation * (1 + 1e-6), double{maxInflation}));
    return PoseVerdict::usable;
}

}  // namespace grapeshot::detail
