#include <grapeshot/scf/detail/advance_kernels.hpp>

#include <grapeshot/core/detail/wide_targets.hpp>

#undef HWY_TARGET_INCLUDE
// NOLINTNEXTLINE(bugprone-macro-parentheses)
#define HWY_TARGET_INCLUDE <grapeshot/scf/detail/advance_kernels.cpp>
#include <hwy/foreach_target.h>

#include <grapeshot/core/detail/wide.hpp>

HWY_BEFORE_NAMESPACE();
namespace grapeshot::detail::HWY_NAMESPACE {

HWY_INLINE Vector16 cornerOf(const TriangleBatch& batch, int corner) {
    return {load(batch.corner[corner][0]), load(batch.corner[corner][1]), load(batch.corner[corner][2])};
}

HWY_INLINE void storeCorner(Vector16 v, TriangleBatch& batch, int corner) {
    store(v.x, batch.corner[corner][0]);
    store(v.y, batch.corner[corner][1]);
    store(v.z, batch.corner[corner][2]);
}

HWY_INLINE Float16 largestEntry(Vector16 v, Float16 soFar) {
    return max(max(soFar, abs(v.x)), max(abs(v.y), abs(v.z)));
}

void placeKernel(const PathBatch& path, const float (&time)[batchWidth], MovingBatch& out) {
    // Differences come first, so that what rounding does follows from the distances and not from the place.
    const Vector16 before = cornerOf(path.beforeA, 0);
    const Vector16 now = cornerOf(path.nowA, 0);
    const Float16 at = load(time);
    for (int corner = 0; corner < 3; ++corner) {
        const Vector16 a = cornerOf(path.beforeA, corner) - before;
        const Vector16 b = cornerOf(path.beforeB, corner) - before;
        const Vector16 velocityA = (cornerOf(path.nowA, corner) - now) - a;
        const Vector16 velocityB = (cornerOf(path.nowB, corner) - now) - b;
        storeCorner(a + velocityA * at, out.a, corner);
        storeCorner(b + velocityB * at, out.b, corner);
        storeCorner(velocityA, out.velocityA, corner);
        storeCorner(velocityB, out.velocityB, corner);
    }
}

/// What all corners have in common.
struct Bounds16 {
    Float16 less;    ///< reach and rounding of heights
    Float16 faster;  ///< rounding of rates
    Float16 acceleration;
    bool isBent;
};

/// How long `room` lasts that closes at a rate, whatever the acceleration does.
HWY_INLINE Float16 lasting(Float16 room, Float16 closing, const Bounds16& bounds) {
    const Float16 least = wide(1e-30F);
    const Float16 straight = select(closing > wide(0), room / max(closing, least), wide(1e30F));
    if (!bounds.isBent) {
        return straight;
    }
    // closing s + acceleration s^2 / 2 = room
    const Float16 root = sqrt(closing * closing + wide(2) * bounds.acceleration * room);
    const Float16 bent = select(closing >= wide(0), wide(2) * room / max(closing + root, least),
                                (root - closing) / max(bounds.acceleration, least));
    return select(bounds.acceleration > wide(0), bent, straight);
}

/// As long as all of B stays above all of A along a direction; whether it is the best one or not.
HWY_INLINE Float16 lastingAlong(const MovingBatch& pairs, Vector16 direction, Vector16 gap, const Bounds16& bounds) {
    const Float16 zero = wide(0);
    const Float16 scale = wide(1) / sqrt(max(dot(direction, direction), wide(1e-36F)));
    const Vector16 n = direction * select(dot(direction, gap) < zero, -scale, scale);
    Float16 heightA[3];
    Float16 rateA[3];
    for (int i = 0; i < 3; ++i) {
        heightA[i] = dot(cornerOf(pairs.a, i), n);
        rateA[i] = dot(cornerOf(pairs.velocityA, i), n);
    }
    Float16 free = wide(1e30F);
    for (int j = 0; j < 3; ++j) {
        const Float16 heightB = dot(cornerOf(pairs.b, j), n) - bounds.less;
        const Float16 rateB = dot(cornerOf(pairs.velocityB, j), n) - bounds.faster;
        for (int i = 0; i < 3; ++i) {
            const Float16 room = heightB - heightA[i];
            free = min(free, select(room > zero, lasting(max(room, zero), rateA[i] - rateB, bounds), zero));
        }
    }
    return free;
}

/// Of an edge feature (3..5), from its corner to the next; any other feature gives none.
HWY_INLINE Vector16 edgeOf(const TriangleBatch& triangles, const float (&feature)[batchWidth]) {
    const Float16 code = load(feature);
    const Vector16 c[3] = {cornerOf(triangles, 0), cornerOf(triangles, 1), cornerOf(triangles, 2)};
    const Vector16 none{wide(0), wide(0), wide(0)};
    return select(code == wide(3), c[1] - c[0],
                  select(code == wide(4), c[2] - c[1], select(code == wide(5), c[0] - c[2], none)));
}

HWY_INLINE Vector16 normalOf(const TriangleBatch& triangles) {
    const Vector16 first = cornerOf(triangles, 0);
    return cross(cornerOf(triangles, 1) - first, cornerOf(triangles, 2) - first);
}

std::uint32_t advanceKernel(const MovingBatch& pairs, const DistanceBatch& apart, float reach, float tolerance,
                            float (&step)[batchWidth]) {
    const Float16 zero = wide(0);
    Float16 extent = zero;
    Float16 speed = zero;
    for (int corner = 0; corner < 3; ++corner) {
        extent = largestEntry(cornerOf(pairs.a, corner), largestEntry(cornerOf(pairs.b, corner), extent));
        speed = largestEntry(cornerOf(pairs.velocityA, corner), largestEntry(cornerOf(pairs.velocityB, corner), speed));
    }
    const Vector16 gap = Vector16{load(apart.onB[0]), load(apart.onB[1]), load(apart.onB[2])} -
                         Vector16{load(apart.onA[0]), load(apart.onA[1]), load(apart.onA[2])};
    const Float16 distance = load(apart.signedDistance);
    const Mask16 touching = distance <= wide(reach) + max(wide(tolerance), extent * wide(1.5e-6F));
    const Float16 acceleration = load(pairs.acceleration);
    const Bounds16 bounds{wide(reach) + extent * wide(6e-7F), speed * wide(6e-7F), acceleration,
                          any(acceleration > zero)};
    alignas(64) float featureA[batchWidth];
    alignas(64) float featureB[batchWidth];
    for (int lane = 0; lane < batchWidth; ++lane) {
        featureA[lane] = static_cast<float>(apart.featureA[lane]);
        featureB[lane] = static_cast<float>(apart.featureB[lane]);
    }
    // Of near triangles the direction of the closest points is mostly rounding; that of a face or of two edges is not.
    Float16 free = lastingAlong(pairs, gap, gap, bounds);
    free = max(free, lastingAlong(pairs, normalOf(pairs.a), gap, bounds));
    free = max(free, lastingAlong(pairs, normalOf(pairs.b), gap, bounds));
    free = max(free, lastingAlong(pairs, cross(edgeOf(pairs.a, featureA), edgeOf(pairs.b, featureB)), gap, bounds));
    // Whatever the direction: the fastest two corners towards each other.
    Float16 fastest = zero;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            const Vector16 v = cornerOf(pairs.velocityA, i) - cornerOf(pairs.velocityB, j);
            fastest = max(fastest, dot(v, v));
        }
    }
    free = max(free, lasting(max(distance - bounds.less, zero), sqrt(fastest) + bounds.faster, bounds));
    storeU(select(touching, zero, free), step);
    return bits(touching);
}

}  // namespace grapeshot::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <grapeshot/core/detail/kernel_table.hpp>

namespace grapeshot::detail {

void placeAt(const PathBatch& path, const float (&time)[batchWidth], MovingBatch& out) noexcept {
    static constexpr auto kernel = GRAPESHOT_KERNEL_TABLE(placeKernel);
    kernel.chosen()(path, time, out);
}

std::uint32_t advance(const MovingBatch& pairs, const DistanceBatch& apart, float reach, float tolerance,
                      float (&step)[batchWidth]) noexcept {
    static constexpr auto kernel = GRAPESHOT_KERNEL_TABLE(advanceKernel);
    return kernel.chosen()(pairs, apart, reach, tolerance, step);
}

}  // namespace grapeshot::detail
#endif
