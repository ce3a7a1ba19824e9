#include <grapeshot/core/detail/hard_triangles.hpp>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace grapeshot::detail {

namespace {

using Eigen::Vector3d;

constexpr int next(int corner) noexcept {
    return corner == 2 ? 0 : corner + 1;
}

/// Corners relative to A's first corner, exact for floats of similar size; edges and normals.
struct Shape {
    std::array<Vector3d, 3> corner;
    std::array<Vector3d, 3> edge;
    Vector3d normal;
    double longest = 0;  ///< edge
    bool flat = false;   ///< height below 1e-10 of the longest edge: a segment or a point

    Shape(const HardTriangle& triangle, const Vector3d& origin) {
        for (int i = 0; i < 3; ++i) {
            corner[i] = triangle.corner[i] - origin;
        }
        for (int i = 0; i < 3; ++i) {
            edge[i] = corner[next(i)] - corner[i];
            longest = std::max(longest, edge[i].norm());
        }
        normal = edge[0].cross(-edge[2]);
        flat = normal.norm() <= 1e-10 * longest * longest;
    }
};

struct Interval {
    double low, high;
};

Interval project(const Shape& shape, const Vector3d& axis) noexcept {
    const double x = axis.dot(shape.corner[0]);
    const double y = axis.dot(shape.corner[1]);
    const double z = axis.dot(shape.corner[2]);
    return {std::min({x, y, z}), std::max({x, y, z})};
}

/// Negative: apart by that, times |axis|. Otherwise the translation along the axis that parts them.
double overlapAlong(const Shape& a, const Shape& b, const Vector3d& axis) noexcept {
    const Interval onA = project(a, axis);
    const Interval onB = project(b, axis);
    return std::min(onA.high - onB.low, onB.high - onA.low);
}

/// Closest points of two segments. Ericson, Real-Time Collision Detection, 5.1.9.
double squaredSegmentDistance(const Vector3d& p, const Vector3d& d, const Vector3d& q, const Vector3d& e,
                              Vector3d& middle) noexcept {
    const Vector3d r = p - q;
    const double dd = d.squaredNorm();
    const double ee = e.squaredNorm();
    const double de = d.dot(e);
    const double denominator = d.cross(e).squaredNorm();
    double s = 0;
    if (denominator > 1e-24 * dd * ee) {
        s = std::clamp((de * e.dot(r) - d.dot(r) * ee) / denominator, 0.0, 1.0);
    }
    const double t = ee > 0 ? std::clamp(e.dot(r + s * d) / ee, 0.0, 1.0) : 0.0;
    s = dd > 0 ? std::clamp(d.dot(q + t * e - p) / dd, 0.0, 1.0) : 0.0;
    const Vector3d onFirst = p + s * d;
    const Vector3d onSecond = q + t * e;
    middle = 0.5 * (onFirst + onSecond);
    return (onFirst - onSecond).squaredNorm();
}

/// Smallest distance of the outlines; the middle of the closest points.
double outlineDistance(const Shape& a, const Shape& b, Vector3d& middle) noexcept {
    double best = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            Vector3d here;
            const double squared = squaredSegmentDistance(a.corner[i], a.edge[i], b.corner[j], b.edge[j], here);
            if (squared < best) {
                best = squared;
                middle = here;
            }
        }
    }
    return std::sqrt(best);
}

double extentOf(const Shape& a, const Shape& b) noexcept {
    return std::max({a.longest, b.longest, b.corner[0].norm()});
}

bool separated(const Shape& a, const Shape& b) noexcept {
    const auto parts = [&](const Vector3d& axis) { return overlapAlong(a, b, axis) < 0; };
    if (parts(a.normal) || parts(b.normal)) {
        return true;
    }
    for (const Vector3d& e : a.edge) {
        for (const Vector3d& g : b.edge) {
            if (parts(e.cross(g))) {
                return true;
            }
        }
    }
    // In the planes: coplanar triangles, and a segment in the plane of a triangle.
    for (const Vector3d& normal : {a.normal, b.normal}) {
        for (int i = 0; i < 3; ++i) {
            if (parts(normal.cross(a.edge[i])) || parts(normal.cross(b.edge[i]))) {
                return true;
            }
        }
    }
    return false;
}

/// A convex polygon; a triangle cut by three lines has at most six corners, rounding may add some.
struct Polygon {
    std::array<Vector3d, 16> corner;
    int count = 0;
    void add(const Vector3d& point) noexcept {
        if (count < static_cast<int>(corner.size())) {
            corner[count++] = point;
        }
    }
};

/// Middle of the points of A's outline that lie in B: A is cut by B's plane, or, where it lies in it, clipped by B's
/// edges. False if nothing is left (touching within rounding).
bool middleIn(const Shape& a, const Shape& b, Vector3d& middle) noexcept {
    const double tolerance = 1e-9 * b.normal.norm() * extentOf(a, b);
    std::array<double, 3> height{};
    double largest = 0;
    for (int i = 0; i < 3; ++i) {
        height[i] = b.normal.dot(a.corner[i] - b.corner[0]);
        largest = std::max(largest, std::abs(height[i]));
    }
    Polygon polygon;
    for (int i = 0; i < 3; ++i) {
        const int k = next(i);
        if (std::abs(height[i]) <= tolerance) {
            polygon.add(a.corner[i]);
        }
        if (std::min(height[i], height[k]) < -tolerance && std::max(height[i], height[k]) > tolerance) {
            polygon.add(a.corner[i] + height[i] / (height[i] - height[k]) * a.edge[i]);
        }
    }
    // Sutherland-Hodgman in B's plane.
    for (int j = 0; j < 3; ++j) {
        const Vector3d inward = b.normal.cross(b.edge[j]);
        const double slack = 1e-9 * inward.norm() * extentOf(a, b);
        Polygon kept;
        for (int k = 0; k < polygon.count; ++k) {
            const Vector3d& here = polygon.corner[k];
            const Vector3d& there = polygon.corner[(k + 1) % polygon.count];
            const double sideHere = inward.dot(here - b.corner[j]);
            const double sideThere = inward.dot(there - b.corner[j]);
            if (sideHere >= -slack) {
                kept.add(here);
            }
            if ((sideHere < -slack && sideThere > slack) || (sideHere > slack && sideThere < -slack)) {
                kept.add(here + sideHere / (sideHere - sideThere) * (there - here));
            }
        }
        polygon = kept;
    }
    if (polygon.count == 0) {
        return false;
    }
    Vector3d sum = Vector3d::Zero();
    for (int k = 0; k < polygon.count; ++k) {
        sum += polygon.corner[k];
    }
    middle = sum / polygon.count;
    return true;
}

}  // namespace

bool hardOverlap(const HardTriangle& first, const HardTriangle& second) noexcept {
    const Shape a(first, first.corner[0]);
    const Shape b(second, first.corner[0]);
    if (separated(a, b)) {
        return false;
    }
    if (a.flat && b.flat) {
        Vector3d ignored;
        return outlineDistance(a, b, ignored) <= 1e-9 * extentOf(a, b);
    }
    return true;
}

HardDepth hardDepth(const HardTriangle& first, const HardTriangle& second) noexcept {
    const Shape a(first, first.corner[0]);
    const Shape b(second, first.corner[0]);
    HardDepth result;
    result.depth = std::numeric_limits<double>::infinity();
    const auto tryAxis = [&](const Vector3d& axis, double least) {
        const double length = axis.norm();
        if (length <= least) {
            return false;
        }
        const double depth = std::max(0.0, overlapAlong(a, b, axis) / length);
        if (depth < result.depth) {
            result.depth = depth;
            return true;
        }
        return false;
    };
    // The corner of the other triangle that is deepest behind a face: the one farthest on the shallow side.
    const auto deepest = [](const Shape& face, const Shape& other) {
        const Interval range = project(other, face.normal);
        const double level = face.normal.dot(face.corner[0]);
        const bool above = range.high - level <= level - range.low;
        int corner = 0;
        for (int i = 1; i < 3; ++i) {
            const double here = face.normal.dot(other.corner[i]);
            const double best = face.normal.dot(other.corner[corner]);
            if (above ? here > best : here < best) {
                corner = i;
            }
        }
        return corner;
    };
    if (!a.flat && tryAxis(a.normal, 0)) {
        result.featureA = 6;
        result.featureB = deepest(a, b);
    }
    if (!b.flat && tryAxis(b.normal, 0)) {
        result.featureA = deepest(b, a);
        result.featureB = 6;
    }
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            // Parallel edges give no axis but rounding.
            const double least = 1e-9 * a.edge[i].norm() * b.edge[j].norm();
            if (tryAxis(a.edge[i].cross(b.edge[j]), least)) {
                result.featureA = 3 + i;
                result.featureB = 3 + j;
            }
        }
    }
    if (!std::isfinite(result.depth)) {
        result.depth = 0;  // two parallel segments or points that touch
    }
    if (!((!b.flat && middleIn(a, b, result.middle)) || (!a.flat && middleIn(b, a, result.middle)))) {
        outlineDistance(a, b, result.middle);
    }
    result.middle += first.corner[0];
    return result;
}

}  // namespace grapeshot::detail
