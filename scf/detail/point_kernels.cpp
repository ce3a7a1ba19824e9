#include <grapeshot/scf/detail/point_kernels.hpp>

#include <grapeshot/core/detail/wide_targets.hpp>

#undef HWY_TARGET_INCLUDE
// NOLINTNEXTLINE(bugprone-macro-parentheses)
#define HWY_TARGET_INCLUDE <grapeshot/scf/detail/point_kernels.cpp>
#include <hwy/foreach_target.h>

#include <grapeshot/core/detail/wide.hpp>

HWY_BEFORE_NAMESPACE();
namespace grapeshot::detail::HWY_NAMESPACE {

/// x / y, and 0 where y is nearly nothing.
HWY_INLINE Float16 shareOf(Float16 x, Float16 y, Float16 least) {
    const Mask16 usable = y > least;
    return select(usable, x / select(usable, y, wide(1)), wide(0));
}

std::uint32_t pointsKernel(const PosedLeaf& leaf, const float (&point)[3], float most, PointDistances& out) {
    const Float16 zero = wide(0);
    const Float16 one = wide(1);
    const Vector16 p{wide(point[0]), wide(point[1]), wide(point[2])};
    const Vector16 c[3] = {{load(leaf.corner[0][0]), load(leaf.corner[0][1]), load(leaf.corner[0][2])},
                           {load(leaf.corner[1][0]), load(leaf.corner[1][1]), load(leaf.corner[1][2])},
                           {load(leaf.corner[2][0]), load(leaf.corner[2][1]), load(leaf.corner[2][2])}};
    const Vector16 e[3] = {c[1] - c[0], c[2] - c[1], c[0] - c[2]};
    const Vector16 r[3] = {p - c[0], p - c[1], p - c[2]};
    Vector16 best{};
    Float16 square{};
    Float16 feature{};
    for (int i = 0; i < 3; ++i) {
        const Float16 along = min(max(shareOf(dot(r[i], e[i]), dot(e[i], e[i]), wide(1e-30F)), zero), one);
        const Vector16 d = r[i] - e[i] * along;
        const Float16 s = dot(d, d);
        const auto first = static_cast<float>(i);
        const auto second = static_cast<float>((i + 1) % 3);
        const Float16 code = select(along <= zero, wide(first), select(along >= one, wide(second), wide(first + 3)));
        if (i == 0) {
            best = d;
            square = s;
            feature = code;
            continue;
        }
        const Mask16 nearer = s < square;
        best = select(nearer, d, best);
        square = select(nearer, s, square);
        feature = select(nearer, code, feature);
    }
    const Vector16 v = -e[2];
    const Vector16 n = cross(e[0], v);
    const Float16 nn = dot(n, n);
    const Float16 least = dot(e[0], e[0]) * dot(v, v) * wide(1e-12F) + wide(1e-36F);
    const Float16 second = shareOf(dot(cross(r[0], v), n), nn, least);
    const Float16 third = shareOf(dot(cross(e[0], r[0]), n), nn, least);
    const Mask16 inside = (nn > least) & (second > zero) & (third > zero) & (second + third < one);
    const Vector16 d = n * shareOf(dot(r[0], n), nn, least);
    const Float16 s = dot(d, d);
    const Mask16 face = inside & (s <= square);
    best = select(face, d, best);
    square = select(face, s, square);
    feature = select(face, wide(6), feature);
    store(square, out.square);
    store(best.x, out.between[0]);
    store(best.y, out.between[1]);
    store(best.z, out.between[2]);
    store(feature, out.feature);
    return bits(square < wide(most));
}

}  // namespace grapeshot::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <grapeshot/core/detail/kernel_table.hpp>

namespace grapeshot::detail {

std::uint32_t pointDistances(const PosedLeaf& leaf, const float (&point)[3], float most, PointDistances& out) noexcept {
    static constexpr auto kernel = GRAPESHOT_KERNEL_TABLE(pointsKernel);
    return kernel.chosen()(leaf, point, most, out);
}

}  // namespace grapeshot::detail
#endif
