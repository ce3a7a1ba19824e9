#include <grapeshot/plugin/detail/feature_crossing.hpp>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

namespace {

using Eigen::Vector3d;

/// (e1 x e2) . r, each linear in time.
struct Cubic {
    double c[4];

    Cubic(const Moving& e1, const Moving& e2, const Moving& r) {
        const Vector3d d1 = e1.to - e1.from;
        const Vector3d d2 = e2.to - e2.from;
        const Vector3d s = r.to - r.from;
        const Vector3d n0 = e1.from.cross(e2.from);
        const Vector3d n1 = e1.from.cross(d2) + d1.cross(e2.from);
        const Vector3d n2 = d1.cross(d2);
        c[0] = n0.dot(r.from);
        c[1] = n0.dot(s) + n1.dot(r.from);
        c[2] = n1.dot(s) + n2.dot(r.from);
        c[3] = n2.dot(s);
    }
    [[nodiscard]] double operator()(double t) const { return c[0] + t * (c[1] + t * (c[2] + t * c[3])); }
    [[nodiscard]] double slope(double t) const { return c[1] + t * (2 * c[2] + 3 * t * c[3]); }

    /// By the signs of its Bernstein coefficients.
    [[nodiscard]] bool hasNoRoot() const {
        const double b1 = c[0] + c[1] / 3;
        const double b2 = c[0] + (2 * c[1] + c[2]) / 3;
        const double b3 = c[0] + c[1] + c[2] + c[3];
        return (c[0] > 0 && b1 > 0 && b2 > 0 && b3 > 0) || (c[0] < 0 && b1 < 0 && b2 < 0 && b3 < 0);
    }

    /// Calls with each change of sign in 0..1, ascending, until it returns true.
    template <class Visit>
    void visitRoots(const Visit& visit) const {
        double knots[4] = {0, 1, 1, 1};
        int count = 1;
        const double root = c[2] * c[2] - 3 * c[1] * c[3];
        if (root >= 0) {
            // The slope's roots, the stable way.
            const double q = -(c[2] + std::copysign(std::sqrt(root), c[2]));
            double turns[2] = {c[3] != 0 ? q / (3 * c[3]) : -1, q != 0 ? c[1] / q : -1};
            if (turns[0] > turns[1]) {
                std::swap(turns[0], turns[1]);
            }
            for (const double turn : turns) {
                if (turn > knots[count - 1] && turn < 1) {
                    knots[count++] = turn;
                }
            }
        }
        knots[count] = 1;
        for (int i = 0; i < count; ++i) {
            double low = knots[i];
            double high = knots[i + 1];
            const bool falls = (*this)(low) > 0;
            if (falls == ((*this)(high) > 0)) {
                continue;
            }
            for (int k = 0; k < 48; ++k) {
                const double middle = 0.5 * (low + high);
                (((*this)(middle) > 0) == falls ? low : high) = middle;
            }
            if (visit(low, falls)) {
                return;
            }
        }
    }
};

Moving difference(const Moving& x, const Moving& y) {
    return {x.from - y.from, x.to - y.to};
}

/// So that no point falls between two triangles.
constexpr double rim = 1e-9;

}  // namespace

std::optional<Crossing> crossingOf(const Moving& point, const std::array<Moving, 3>& triangle) {
    const Moving e1 = difference(triangle[1], triangle[0]);
    const Moving e2 = difference(triangle[2], triangle[0]);
    const Moving r = difference(point, triangle[0]);
    const Cubic volume(e1, e2, r);
    if (volume.hasNoRoot()) {
        return std::nullopt;
    }
    std::optional<Crossing> result;
    volume.visitRoots([&](double time, bool falls) {
        const Vector3d u = e1.at(time);
        const Vector3d v = e2.at(time);
        const Vector3d n = u.cross(v);
        const double square = n.squaredNorm();
        if (!(square > 0)) {
            return false;
        }
        const Vector3d w = r.at(time);
        const double second = w.cross(v).dot(n) / square;
        const double third = u.cross(w).dot(n) / square;
        if (second < -rim || third < -rim || second + third > 1 + rim) {
            return false;
        }
        result = Crossing{time, {1 - second - third, second, third}, (falls ? 1 : -1) / std::sqrt(square) * n};
        return true;
    });
    return result;
}

std::optional<EdgeCrossing> crossingOf(const std::array<Moving, 2>& first, const std::array<Moving, 2>& second) {
    const Moving u = difference(first[1], first[0]);
    const Moving v = difference(second[1], second[0]);
    const Moving r = difference(first[0], second[0]);
    const Cubic volume(u, v, r);
    if (volume.hasNoRoot()) {
        return std::nullopt;
    }
    std::optional<EdgeCrossing> result;
    volume.visitRoots([&](double time, bool falls) {
        const auto inside =
            nearestInside({first[0].at(time), first[1].at(time)}, {second[0].at(time), second[1].at(time)});
        if (!inside) {
            return false;
        }
        const Vector3d n = u.at(time).cross(v.at(time)).normalized();
        result = EdgeCrossing{time, inside->x(), inside->y(), falls ? n : Vector3d(-n)};
        return true;
    });
    return result;
}

Vector3d nearestOn(const Vector3d& point, const std::array<Vector3d, 3>& triangle) {
    // Ericson, Real-Time Collision Detection, 5.1.5
    const Vector3d ab = triangle[1] - triangle[0];
    const Vector3d ac = triangle[2] - triangle[0];
    const Vector3d ap = point - triangle[0];
    const double d1 = ab.dot(ap);
    const double d2 = ac.dot(ap);
    if (d1 <= 0 && d2 <= 0) {
        return {1, 0, 0};
    }
    const Vector3d bp = point - triangle[1];
    const double d3 = ab.dot(bp);
    const double d4 = ac.dot(bp);
    if (d3 >= 0 && d4 <= d3) {
        return {0, 1, 0};
    }
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) {
        const double v = d1 - d3 > 0 ? d1 / (d1 - d3) : 0;
        return {1 - v, v, 0};
    }
    const Vector3d cp = point - triangle[2];
    const double d5 = ab.dot(cp);
    const double d6 = ac.dot(cp);
    if (d6 >= 0 && d5 <= d6) {
        return {0, 0, 1};
    }
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) {
        const double w = d2 - d6 > 0 ? d2 / (d2 - d6) : 0;
        return {1 - w, 0, w};
    }
    const double va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
        const double sum = (d4 - d3) + (d5 - d6);
        const double w = sum > 0 ? (d4 - d3) / sum : 0;
        return {0, 1 - w, w};
    }
    const double scale = 1 / (va + vb + vc);
    return {va * scale, vb * scale, vc * scale};
}

std::optional<Eigen::Vector2d> nearestInside(const std::array<Vector3d, 2>& first,
                                             const std::array<Vector3d, 2>& second) {
    const Vector3d u = first[1] - first[0];
    const Vector3d v = second[1] - second[0];
    const Vector3d r = first[0] - second[0];
    const double uu = u.squaredNorm();
    const double vv = v.squaredNorm();
    const double uv = u.dot(v);
    const double det = uu * vv - uv * uv;
    if (!(det > 1e-10 * uu * vv)) {
        return std::nullopt;
    }
    const double s = (uv * v.dot(r) - vv * u.dot(r)) / det;
    const double t = (uu * v.dot(r) - uv * u.dot(r)) / det;
    if (s < -rim || s > 1 + rim || t < -rim || t > 1 + rim) {
        return std::nullopt;
    }
    return Eigen::Vector2d(std::clamp(s, 0.0, 1.0), std::clamp(t, 0.0, 1.0));
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
