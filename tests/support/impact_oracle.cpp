#include <support/impact_oracle.hpp>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include <support/oracle.hpp>

namespace grapeshot::test {

namespace {

constexpr double slack = 1e-9;    // of barycentric coordinates: corners and edges belong to both sides
constexpr double meeting = 1e-7;  // m: edges that stay parallel have roots and parameters of rounding alone

struct MovingPoint {
    Eigen::Vector3d before, now;
    [[nodiscard]] Eigen::Vector3d at(double t) const { return before + t * (now - before); }
};

double triple(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
    return a.cross(b).dot(c);
}

/// Where u(t), v(t) and w(t) may be coplanar within [from, to], ascending.
class CoplanarTimes {
  public:
    CoplanarTimes(const MovingPoint& u, const MovingPoint& v, const MovingPoint& w, double from, double to) {
        const Eigen::Vector3d du = u.now - u.before;
        const Eigen::Vector3d dv = v.now - v.before;
        const Eigen::Vector3d dw = w.now - w.before;
        m_c = {triple(u.before, v.before, w.before),
               triple(du, v.before, w.before) + triple(u.before, dv, w.before) + triple(u.before, v.before, dw),
               triple(du, dv, w.before) + triple(du, v.before, dw) + triple(u.before, dv, dw), triple(du, dv, dw)};
        // Between the zeros of the derivative it is monotone.
        std::array<double, 4> ends{from, from, from, to};
        const double a = 3 * m_c[3];
        const double b = 2 * m_c[2];
        const double square = b * b - 4 * a * m_c[1];
        if (square > 0) {
            const double q = -0.5 * (b + std::copysign(std::sqrt(square), b));
            ends[1] = a != 0 ? std::clamp(q / a, from, to) : from;
            ends[2] = q != 0 ? std::clamp(m_c[1] / q, from, to) : from;
        }
        std::sort(ends.begin(), ends.end());
        for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
            bisect(ends[i], ends[i + 1]);
        }
    }
    [[nodiscard]] std::span<const double> all() const { return {m_times.data(), m_count}; }

  private:
    [[nodiscard]] double value(double t) const { return m_c[0] + t * (m_c[1] + t * (m_c[2] + t * m_c[3])); }
    void bisect(double low, double high) {
        const bool isPositive = value(low) > 0;
        if (low >= high || isPositive == (value(high) > 0)) {
            return;
        }
        for (int i = 0; i < 60; ++i) {
            const double middle = 0.5 * (low + high);
            (isPositive == (value(middle) > 0) ? low : high) = middle;
        }
        m_times[m_count++] = high;
    }
    std::array<double, 4> m_c{};
    std::array<double, 3> m_times{};
    std::size_t m_count = 0;
};

MovingPoint operator-(const MovingPoint& a, const MovingPoint& b) {
    return {a.before - b.before, a.now - b.now};
}

double cornerAndFace(const MovingPoint& p, const std::array<MovingPoint, 3>& face, double from, double to) {
    for (const double t : CoplanarTimes(face[1] - face[0], face[2] - face[0], p - face[0], from, to).all()) {
        const Eigen::Vector3d u = (face[1] - face[0]).at(t);
        const Eigen::Vector3d v = (face[2] - face[0]).at(t);
        const Eigen::Vector3d r = (p - face[0]).at(t);
        const Eigen::Vector3d n = u.cross(v);
        const double s = r.cross(v).dot(n) / n.squaredNorm();
        const double q = u.cross(r).dot(n) / n.squaredNorm();
        if (s >= -slack && q >= -slack && s + q <= 1 + slack && (r - s * u - q * v).norm() < meeting) {
            return t;
        }
    }
    return noImpact;
}

double edgeAndEdge(const MovingPoint& a, const MovingPoint& a2, const MovingPoint& b, const MovingPoint& b2,
                   double from, double to) {
    for (const double t : CoplanarTimes(a2 - a, b2 - b, b - a, from, to).all()) {
        const Eigen::Vector3d u = (a2 - a).at(t);
        const Eigen::Vector3d v = (b2 - b).at(t);
        const Eigen::Vector3d r = (b - a).at(t);
        const Eigen::Vector3d n = u.cross(v);
        const double s = r.cross(v).dot(n) / n.squaredNorm();
        const double q = r.cross(u).dot(n) / n.squaredNorm();
        if (s >= -slack && s <= 1 + slack && q >= -slack && q <= 1 + slack && (r - s * u + q * v).norm() < meeting) {
            return t;
        }
    }
    return noImpact;
}

Corners cornersAt(const std::array<MovingPoint, 3>& triangle, double t) {
    return {triangle[0].at(t), triangle[1].at(t), triangle[2].at(t)};
}

using MovingTriangle = std::array<MovingPoint, 3>;

double impactOf(const MovingTriangle& a, const MovingTriangle& b, double from, double to) {
    if (trianglesOverlap(cornersAt(a, from), cornersAt(b, from))) {
        return from;
    }
    double first = noImpact;
    for (std::size_t i = 0; i < 3; ++i) {
        first = std::min({first, cornerAndFace(a[i], b, from, to), cornerAndFace(b[i], a, from, to)});
        for (std::size_t j = 0; j < 3; ++j) {
            first = std::min(first, edgeAndEdge(a[i], a[(i + 1) % 3], b[j], b[(j + 1) % 3], from, to));
        }
    }
    return first;
}

MovingTriangle triangleOf(const MovingMesh& mesh, std::size_t t) {
    MovingTriangle result;
    for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t v = mesh.triangles[t][i];
        result[i] = {mesh.before[v].cast<double>(), mesh.now[v].cast<double>()};
    }
    return result;
}

/// Around all of a part of the step.
struct Box {
    Eigen::Array3d low = Eigen::Array3d::Constant(noImpact);
    Eigen::Array3d high = Eigen::Array3d::Constant(-noImpact);
    void add(const Eigen::Vector3d& p) {
        low = low.min(p.array());
        high = high.max(p.array());
    }
    [[nodiscard]] bool meets(const Box& other) const { return (low <= other.high).all() && (other.low <= high).all(); }
};

std::vector<Box> boxesOf(const MovingMesh& mesh, std::span<const std::size_t> which, double from, double to, Box& all) {
    std::vector<Box> boxes;
    boxes.reserve(which.size());
    for (const std::size_t t : which) {
        Box box;
        for (const std::uint32_t v : mesh.triangles[t]) {
            const MovingPoint corner{mesh.before[v].cast<double>(), mesh.now[v].cast<double>()};
            box.add(corner.at(from));
            box.add(corner.at(to));
        }
        box.low -= slack;
        box.high += slack;
        all.add(box.low.matrix());
        all.add(box.high.matrix());
        boxes.push_back(box);
    }
    return boxes;
}

}  // namespace

std::vector<TriangleImpact> allImpacts(const MovingMesh& a, const MovingMesh& b) {
    std::vector<std::size_t> every(std::max(a.triangles.size(), b.triangles.size()));
    std::iota(every.begin(), every.end(), std::size_t{0});
    Box all;
    const std::vector<Box> boxesA = boxesOf(a, std::span(every).first(a.triangles.size()), 0, 1, all);
    const std::vector<Box> boxesB = boxesOf(b, std::span(every).first(b.triangles.size()), 0, 1, all);
    std::vector<TriangleImpact> result;
    for (std::size_t i = 0; i < boxesA.size(); ++i) {
        for (std::size_t j = 0; j < boxesB.size(); ++j) {
            if (!boxesA[i].meets(boxesB[j])) {
                continue;
            }
            if (const double time = impactOf(triangleOf(a, i), triangleOf(b, j), 0, 1); time != noImpact) {
                result.push_back({static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j), time});
            }
        }
    }
    return result;
}

double meshImpact(const MovingMesh& a, const MovingMesh& b) {
    constexpr int parts = 16;
    // Whoever does not come near the other in all of the step needs no second look.
    const auto nearOnes = [](const MovingMesh& mesh, const MovingMesh& other) {
        Box all;
        Box otherAll;
        std::vector<std::size_t> every(std::max(mesh.triangles.size(), other.triangles.size()));
        std::iota(every.begin(), every.end(), std::size_t{0});
        const std::vector<Box> boxes = boxesOf(mesh, std::span(every).first(mesh.triangles.size()), 0, 1, all);
        boxesOf(other, std::span(every).first(other.triangles.size()), 0, 1, otherAll);
        std::erase_if(every, [&](std::size_t t) { return t >= boxes.size() || !boxes[t].meets(otherAll); });
        return every;
    };
    const std::vector<std::size_t> nearA = nearOnes(a, b);
    const std::vector<std::size_t> nearB = nearOnes(b, a);
    for (int part = 0; part < parts; ++part) {
        const double from = static_cast<double>(part) / parts;
        const double to = static_cast<double>(part + 1) / parts;
        Box allA;
        Box allB;
        const std::vector<Box> boxesA = boxesOf(a, nearA, from, to, allA);
        const std::vector<Box> boxesB = boxesOf(b, nearB, from, to, allB);
        double first = noImpact;
        for (std::size_t j = 0; j < boxesB.size(); ++j) {
            for (std::size_t i = 0; boxesB[j].meets(allA) && i < boxesA.size(); ++i) {
                if (boxesA[i].meets(boxesB[j])) {
                    first = std::min(first, impactOf(triangleOf(a, nearA[i]), triangleOf(b, nearB[j]), from, to));
                }
            }
        }
        if (first <= to) {
            return first;
        }
    }
    return noImpact;
}

}  // namespace grapeshot::test
