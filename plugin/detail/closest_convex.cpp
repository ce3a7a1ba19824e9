#include <grapeshot/plugin/detail/closest_convex.hpp>

#include <BulletCollision/CollisionShapes/btTriangleShape.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkEpaPenetrationDepthSolver.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkPairDetector.h>
#include <BulletCollision/NarrowPhaseCollision/btPointCollector.h>
#include <BulletCollision/NarrowPhaseCollision/btVoronoiSimplexSolver.h>

#include <algorithm>

#include <grapeshot/plugin/detail/convert.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

ClosestToConvex closestToConvex(std::span<const Eigen::Vector3f> positions, std::span<const Triangle> triangles,
                                const btConvexShape& convex, const btTransform& pose, float maxDistance) {
    ClosestToConvex best;
    best.distance = maxDistance;
    btVector3 lower;
    btVector3 upper;
    convex.getAabb(pose, lower, upper);
    const Eigen::Vector3f low = toEigen(lower);
    const Eigen::Vector3f high = toEigen(upper);
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
        const auto at = [&](std::size_t i) { return positions[triangles[t][i]]; };
        const Eigen::Vector3f least = at(0).cwiseMin(at(1)).cwiseMin(at(2));
        const Eigen::Vector3f most = at(0).cwiseMax(at(1)).cwiseMax(at(2));
        const Eigen::Vector3f gap = (least - high).cwiseMax(low - most).cwiseMax(0);
        if (gap.norm() > best.distance || (best.found && best.distance == 0)) {
            continue;
        }
        btTriangleShape triangle(toBullet(at(0)), toBullet(at(1)), toBullet(at(2)));
        triangle.setMargin(0);
        btVoronoiSimplexSolver simplex;
        btGjkEpaPenetrationDepthSolver penetration;
        btGjkPairDetector detector(&triangle, &convex, &simplex, &penetration);
        btGjkPairDetector::ClosestPointInput input;
        input.m_transformA.setIdentity();
        input.m_transformB = pose;
        btPointCollector point;
        detector.getClosestPoints(input, point, nullptr);
        if (!point.m_hasResult || static_cast<float>(point.m_distance) > best.distance ||
            (best.found && static_cast<float>(point.m_distance) == best.distance)) {
            continue;
        }
        best.found = true;
        best.triangle = t;
        best.distance = std::max(0.0F, static_cast<float>(point.m_distance));
        best.onConvex = toEigen(point.m_pointInWorld);
        best.onSurface = toEigen(point.m_pointInWorld + point.m_normalOnBInWorld * point.m_distance);
    }
    return best;
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
