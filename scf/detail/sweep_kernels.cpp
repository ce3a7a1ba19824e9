#include <grapeshot/scf/detail/sweep_kernels.hpp>

#include <grapeshot/core/detail/wide_targets.hpp>

#undef HWY_TARGET_INCLUDE
// NOLINTNEXTLINE(bugprone-macro-parentheses)
#define HWY_TARGET_INCLUDE <grapeshot/scf/detail/sweep_kernels.cpp>
#include <hwy/foreach_target.h>

#include <grapeshot/core/detail/wide.hpp>

HWY_BEFORE_NAMESPACE();
namespace grapeshot::detail::HWY_NAMESPACE {

struct Meeting16 {
    Mask16 meets;
    Float16 time;
    Float16 overlap;
};

HWY_INLINE Float16 longest(Vector16 v) {
    return abs(v.x) + abs(v.y) + abs(v.z);
}

/// A point that is at `d` and goes along `w`, and the ball around the origin. By way of the nearest point, which is
/// evaluated: the discriminant of the quadratic would lose small balls that are far away.
HWY_INLINE Meeting16 meetingOf(Vector16 d, Vector16 w, Float16 sum, Float16 limit) {
    const Float16 zero = wide(0);
    const Float16 one16 = wide(1);
    const Float16 radius = sum + wide(4e-7F) * (longest(d) + longest(w));
    const Float16 ww = dot(w, w);
    const Float16 dw = dot(d, w);
    const Float16 over = one16 / max(ww, wide(1e-36F));
    const Float16 raw = -dw * over;
    const Float16 nearest = min(max(raw, zero), one16);
    const Vector16 p = d + w * nearest;
    const Float16 pp = dot(p, p);
    const Float16 square = radius * radius;
    const Float16 left = square - pp;
    // At the nearest point the path is square to p, unless the step ends before it.
    const Float16 pw = select(raw > one16, min(dot(p, w), zero), zero);
    const Float16 back = left / max(sqrt(max(pw * pw + ww * left, zero)) - pw, wide(1e-36F));
    const Float16 time = max(nearest - back * wide(1.00001F) - wide(1e-6F), zero);
    const Mask16 inside = dot(d, d) <= square;
    const Mask16 apart = (left < zero) | ((!inside) & (time >= limit));
    Meeting16 meeting;
    meeting.meets = !apart;
    meeting.time = select(inside, zero, time);
    meeting.overlap = left / max(square, wide(1e-36F));
    return meeting;
}

std::uint32_t ballsMeetKernel(const SweptBalls& a, const SweptBalls& b, float reach, float limit, float (&time)[16],
                              float (&overlap)[16]) {
    const Vector16 d = Vector16{spreadA(a.center[0]), spreadA(a.center[1]), spreadA(a.center[2])} -
                       Vector16{repeatB(b.center[0]), repeatB(b.center[1]), repeatB(b.center[2])};
    const Vector16 w = Vector16{spreadA(a.path[0]), spreadA(a.path[1]), spreadA(a.path[2])} -
                       Vector16{repeatB(b.path[0]), repeatB(b.path[1]), repeatB(b.path[2])};
    const Meeting16 meeting = meetingOf(d, w, spreadA(a.radius) + repeatB(b.radius) + wide(reach), wide(limit));
    storeU(meeting.time, time);
    storeU(meeting.overlap, overlap);
    return bits(meeting.meets);
}

std::uint32_t leafMeetsKernel(const SweptBall& one, const SweptLeaf& leaf, float reach, float limit, float (&time)[16],
                              float (&overlap)[16]) {
    const Vector16 d = Vector16{load(leaf.center[0]), load(leaf.center[1]), load(leaf.center[2])} -
                       Vector16{wide(one.center[0]), wide(one.center[1]), wide(one.center[2])};
    const Vector16 w = Vector16{load(leaf.path[0]), load(leaf.path[1]), load(leaf.path[2])} -
                       Vector16{wide(one.path[0]), wide(one.path[1]), wide(one.path[2])};
    const Meeting16 meeting = meetingOf(d, w, load(leaf.radius) + wide(one.radius) + wide(reach), wide(limit));
    storeU(meeting.time, time);
    storeU(meeting.overlap, overlap);
    return bits(meeting.meets);
}

}  // namespace grapeshot::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <grapeshot/core/detail/kernel_table.hpp>

namespace grapeshot::detail {

std::uint32_t sweptBallsMeet(const SweptBalls& a, const SweptBalls& b, float reach, float limit, float (&time)[16],
                             float (&overlap)[16]) noexcept {
    static constexpr auto kernel = GRAPESHOT_KERNEL_TABLE(ballsMeetKernel);
    return kernel.chosen()(a, b, reach, limit, time, overlap);
}

std::uint32_t sweptLeafMeets(const SweptBall& one, const SweptLeaf& leaf, float reach, float limit, float (&time)[16],
                             float (&overlap)[16]) noexcept {
    static constexpr auto kernel = GRAPESHOT_KERNEL_TABLE(leafMeetsKernel);
    return kernel.chosen()(one, leaf, reach, limit, time, overlap);
}

}  // namespace grapeshot::detail
#endif
