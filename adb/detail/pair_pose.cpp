#include <grapeshot/adb/detail/pair_pose.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include <grapeshot/adb/detail/tree_contents.hpp>

namespace grapeshot::detail {
namespace {

constexpr float rigidTolerance = 1e-3F;  // as isRigid has it

/// The largest power of two that is not above 1 / length, within the range of sizes that meshes may have.
float inverseUnit(float length) {
    const float inverse = 1 / std::clamp(length, 1e-30F, 1e30F);
    return std::bit_cast<float>(std::bit_cast<std::uint32_t>(inverse) & 0x7f800000U);
}

using Four = float __attribute__((vector_size(16)));
using FourBits = std::int32_t __attribute__((vector_size(16)));

FourBits bitsOf(Four a) {
    return std::bit_cast<FourBits>(a);
}
Four magnitude(Four a) {
    return std::bit_cast<Four>(bitsOf(a) & 0x7fffffff);
}
/// Denormal operands would make the kernel ten times slower; what becomes of them here is far below the slack.
Four flushed(Four a) {
    return std::bit_cast<Four>(bitsOf(a) & ~(magnitude(a) < 1e-30F));
}

}  // namespace

// In single precision, four at a time: the shortest queries take not much longer than this.
PoseVerdict prepare(const Pose& bInA, float radiusA, float radiusB, float maxDistance, PairPose& out) noexcept {
    const float* const c = bInA.rotation.data();
    const float* const t = bInA.translation.data();
    // Coordinates of the three columns, and of the translation.
    const Four x = flushed(Four{c[0], c[3], c[6], t[0]});
    const Four y = flushed(Four{c[1], c[4], c[7], t[1]});
    const Four z = flushed(Four{c[2], c[5], c[8], t[2]});
    std::memcpy(out.row[0], &x, sizeof(x));
    std::memcpy(out.row[1], &y, sizeof(y));
    std::memcpy(out.row[2], &z, sizeof(z));
    const Four columns[3] = {Four{x[0], y[0], z[0], 0}, Four{x[1], y[1], z[1], 0}, Four{x[2], y[2], z[2], 0}};
    const Four rows[3] = {x, y, z};
    for (int i = 0; i < 3; ++i) {
        const Four first = __builtin_shufflevector(rows[i], columns[i], 0, 4, 1, 5);
        const Four last = __builtin_shufflevector(rows[i], columns[i], 2, 6, 3, 7);
        std::memcpy(out.pairs[i], &first, sizeof(first));
        std::memcpy(out.pairs[i] + 4, &last, sizeof(last));
    }
    // R^T R - I: the diagonal, and the rest of it from the columns in turn; the largest of their entries, and what
    // rounding may have taken from it.
    const Four nextX = __builtin_shufflevector(x, x, 1, 2, 0, 3);
    const Four nextY = __builtin_shufflevector(y, y, 1, 2, 0, 3);
    const Four nextZ = __builtin_shufflevector(z, z, 1, 2, 0, 3);
    const Four lastY = __builtin_shufflevector(y, y, 2, 0, 1, 3);
    const Four lastZ = __builtin_shufflevector(z, z, 2, 0, 1, 3);
    const Four squares = x * x + y * y + z * z;
    const Four products = x * nextX + y * nextY + z * nextZ;
    const Four offDiagonal = magnitude(products);
    const Four offOne = magnitude(squares - 1.0F);
    const Four worst = offDiagonal > offOne ? offDiagonal : offOne;
    const FourBits within = (offDiagonal <= rigidTolerance) & (offOne <= rigidTolerance);  // false for NaN
    const Four triple = x * (nextY * lastZ - lastY * nextZ);
    const float skew = std::max(std::max(worst[0], worst[1]), worst[2]) + 0x1p-22F;
    const float squaredShift = squares[3];  // overflows to infinity: that is apart
    const Four shifts = magnitude(Four{t[0], t[1], t[2], 0});
    const FourBits finite = shifts <= std::numeric_limits<float>::max();
    const FourBits sound = (within | FourBits{0, 0, 0, -1}) & finite;
    if (((sound[0] & sound[1]) & (sound[2] & sound[3])) == 0 || !(triple[0] + triple[1] + triple[2] > 0)) {
        return PoseVerdict::invalid;
    }
    constexpr float up = 1 + 0x1p-19F;                           // more than what is rounded away below
    const float distance = std::min(maxDistance, maxInflation);  // infinity would make NaN of the products below
    const float reach = (radiusA + radiusB * (1 + 2 * skew)) * up;
    const float shift = std::sqrt(squaredShift);
    if (shift > (reach + distance) * up) {
        return PoseVerdict::apart;
    }
    out.perLength = inverseUnit(radiusA + radiusB);
    out.areaOctaves = 4 * (static_cast<float>(std::bit_cast<std::uint32_t>(out.perLength) >> 23U) - 127);
    // Rounding. Centres and half extents are at most sqrt(3) radii long, so everything the kernel adds up stays below
    // S = 2 sqrt(3) (rA + rB) + |t|. The longest chain (box centre through R and R^T onto a slab's normal) makes fewer
    // than 32 roundings of at most S / 2^24 each. The tiny constant is for denormals, also where the host flushes them.
    const float extent = 3.5F * reach + shift;
    const float rounding = 32 * 0x1p-24F * extent + 1e-35F;
    // With R^T R = I + E, B's own axes and slabs, measured by R^T for the inverse, are off by |E p| for p on B.
    const float crooked = 3 * skew * (radiusB + distance);
    out.threshold = -std::min((distance + rounding + crooked) * up, maxInflation);
    return PoseVerdict::usable;
}

}  // namespace grapeshot::detail
