#include <grapeshot/scf/reference/simplex_distance.hpp>

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <optional>

namespace grapeshot::scf::reference {

namespace {

using Eigen::Vector3d;

struct OnSimplex {
    Vector3d point;
    unsigned part;
};

OnSimplex closestOnSegment(const Vector3d& p, const Vector3d& a, const Vector3d& b) {
    const Vector3d along = b - a;
    const double t = (p - a).dot(along);
    const double length2 = along.squaredNorm();
    if (t <= 0 || length2 == 0) {
        return {a, 1};
    }
    if (t >= length2) {
        return {b, 2};
    }
    return {a + t / length2 * along, 3};
}

OnSimplex closestOnTriangle(const Vector3d& p, const std::array<Vector3d, 3>& c) {
    const Vector3d ab = c[1] - c[0];
    const Vector3d ac = c[2] - c[0];
    const double d1 = ab.dot(p - c[0]);
    const double d2 = ac.dot(p - c[0]);
    if (d1 <= 0 && d2 <= 0) {
        return {c[0], 1};
    }
    const double d3 = ab.dot(p - c[1]);
    const double d4 = ac.dot(p - c[1]);
    if (d3 >= 0 && d4 <= d3) {
        return {c[1], 2};
    }
    const double d5 = ab.dot(p - c[2]);
    const double d6 = ac.dot(p - c[2]);
    if (d6 >= 0 && d5 <= d6) {
        return {c[2], 4};
    }
    const double w2 = d1 * d4 - d3 * d2;
    if (w2 <= 0 && d1 > 0 && d3 < 0) {
        return {c[0] + d1 / (d1 - d3) * ab, 3};
    }
    const double w1 = d5 * d2 - d1 * d6;
    if (w1 <= 0 && d2 > 0 && d6 < 0) {
        return {c[0] + d2 / (d2 - d6) * ac, 5};
    }
    const double w0 = d3 * d6 - d5 * d4;
    if (w0 <= 0 && d4 - d3 > 0 && d5 - d6 > 0) {
        return {c[1] + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c[2] - c[1]), 6};
    }
    const double sum = w0 + w1 + w2;
    if (!(sum > 0)) {  // no area left in double precision: some edge is as close
        return closestOnSegment(p, c[0], c[1]);
    }
    return {c[0] + w1 / sum * ab + w2 / sum * ac, 7};
}

OnSimplex closestOn(const Vector3d& p, const Simplex& simplex) {
    switch (simplex.count) {
        case 1:
            return {simplex.corners[0], 1};
        case 2:
            return closestOnSegment(p, simplex.corners[0], simplex.corners[1]);
        default:
            return closestOnTriangle(p, simplex.corners);
    }
}

struct Edge {
    int from, to;
    [[nodiscard]] unsigned part() const { return 1U << unsigned(from) | 1U << unsigned(to); }
};

constexpr std::array<Edge, 3> edges{{{0, 1}, {1, 2}, {2, 0}}};

int edgeCount(const Simplex& simplex) {
    return simplex.count == 3 ? 3 : simplex.count - 1;
}

/// Only where both closest points are inside the segments: their ends are tried anyway.
std::optional<ClosestPoints> insideSegments(const Simplex& a, const Edge& edgeA, const Simplex& b, const Edge& edgeB) {
    const Vector3d& p = a.corners[std::size_t(edgeA.from)];
    const Vector3d& q = b.corners[std::size_t(edgeB.from)];
    const Vector3d u = a.corners[std::size_t(edgeA.to)] - p;
    const Vector3d v = b.corners[std::size_t(edgeB.to)] - q;
    const double uu = u.squaredNorm();
    const double vv = v.squaredNorm();
    const double uv = u.dot(v);
    const double determinant = uu * vv - uv * uv;
    if (!(determinant > 1e-14 * uu * vv)) {
        return std::nullopt;
    }
    const Vector3d r = p - q;
    const double s = (uv * v.dot(r) - vv * u.dot(r)) / determinant;
    const double t = (uu * v.dot(r) - uv * u.dot(r)) / determinant;
    if (!(s > 0 && s < 1 && t > 0 && t < 1)) {
        return std::nullopt;
    }
    const Vector3d onA = p + s * u;
    const Vector3d onB = q + t * v;
    return ClosestPoints{(onA - onB).norm(), onA, onB, edgeA.part(), edgeB.part()};
}

std::optional<Vector3d> crossing(const Vector3d& from, const Vector3d& to, const std::array<Vector3d, 3>& c) {
    const Vector3d normal = (c[1] - c[0]).cross(c[2] - c[0]);
    const double before = normal.dot(from - c[0]);
    const double after = normal.dot(to - c[0]);
    if ((before > 0) == (after > 0) || before == after) {
        return std::nullopt;
    }
    const Vector3d at = from + before / (before - after) * (to - from);
    for (std::size_t e = 0; e < 3; ++e) {
        if (normal.dot((c[(e + 1) % 3] - c[e]).cross(at - c[e])) < 0) {
            return std::nullopt;
        }
    }
    return at;
}

void tryCrossings(const Simplex& segments, const Simplex& face, bool facesAreB, ClosestPoints& best) {
    if (face.count < 3) {
        return;
    }
    for (int e = 0; e < edgeCount(segments); ++e) {
        const Edge& edge = edges[std::size_t(e)];
        const auto at =
            crossing(segments.corners[std::size_t(edge.from)], segments.corners[std::size_t(edge.to)], face.corners);
        if (at && best.distance > 0) {
            best = {0, *at, *at, facesAreB ? edge.part() : 7, facesAreB ? 7 : edge.part()};
        }
    }
}

}  // namespace

ClosestPoints closestPoints(const Simplex& a, const Simplex& b) {
    ClosestPoints best;
    best.distance = std::numeric_limits<double>::infinity();
    const auto take = [&](const ClosestPoints& found) {
        const int parts = __builtin_popcount(found.partOfA) + __builtin_popcount(found.partOfB);
        const int bestParts = __builtin_popcount(best.partOfA) + __builtin_popcount(best.partOfB);
        if (found.distance < best.distance || (found.distance == best.distance && parts < bestParts)) {
            best = found;
        }
    };
    for (int i = 0; i < a.count; ++i) {
        const Vector3d& p = a.corners[std::size_t(i)];
        const OnSimplex q = closestOn(p, b);
        take({(p - q.point).norm(), p, q.point, 1U << unsigned(i), q.part});
    }
    for (int i = 0; i < b.count; ++i) {
        const Vector3d& q = b.corners[std::size_t(i)];
        const OnSimplex p = closestOn(q, a);
        take({(p.point - q).norm(), p.point, q, p.part, 1U << unsigned(i)});
    }
    for (int i = 0; i < edgeCount(a); ++i) {
        for (int j = 0; j < edgeCount(b); ++j) {
            if (const auto inside = insideSegments(a, edges[std::size_t(i)], b, edges[std::size_t(j)])) {
                take(*inside);
            }
        }
    }
    tryCrossings(a, b, true, best);
    tryCrossings(b, a, false, best);
    return best;
}

}  // namespace grapeshot::scf::reference
