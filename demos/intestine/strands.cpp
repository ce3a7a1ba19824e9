#include "strands.hpp"

#include <algorithm>
#include <cmath>

#include "organ.hpp"

namespace grapeshot::intestine {

using Eigen::Vector3d;

namespace {

/// The vector between the nearest points of two segments. Standard clamping, see Ericson, Real-Time Collision
/// Detection, 5.1.9.
Vector3d between(const Vector3d& p, const Vector3d& pEnd, const Vector3d& q, const Vector3d& qEnd) {
    const Vector3d u = pEnd - p;
    const Vector3d v = qEnd - q;
    const Vector3d w = p - q;
    const double a = u.squaredNorm();
    const double e = v.squaredNorm();
    const double b = u.dot(v);
    const double c = u.dot(w);
    const double f = v.dot(w);
    const double det = a * e - b * b;
    double s = det > 1e-12 ? std::clamp((b * f - c * e) / det, 0.0, 1.0) : 0.0;
    double t = e > 0 ? (b * s + f) / e : 0;
    if (t < 0 || t > 1) {
        t = std::clamp(t, 0.0, 1.0);
        s = a > 0 ? std::clamp((b * t - c) / a, 0.0, 1.0) : 0.0;
    }
    return q + t * v - p - s * u;
}

}  // namespace

Vector3d StrandWatch::middleOf(int ring) const {
    Vector3d sum = Vector3d::Zero();
    for (int k = 0; k < m_around; ++k) {
        const btVector3& x = m_body->m_nodes[ring * m_around + k].m_x;
        sum += Vector3d(static_cast<double>(x.x()), static_cast<double>(x.y()), static_cast<double>(x.z()));
    }
    return sum / m_around;
}

std::size_t StrandWatch::passed() {
    const int stride = std::max(1, m_around / 6);
    std::vector<Vector3d> points;
    for (int ring = 0; ring < m_rings; ring += stride) {
        points.push_back(middleOf(ring));
    }
    constexpr std::size_t apart = 6;  // pieces: nearer along the tube it is the same bend
    const double reach = 2 * tubeRadius;
    std::map<std::pair<std::size_t, std::size_t>, Vector3d> now;
    std::size_t count = 0;
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
        for (std::size_t k = i + apart; k + 1 < points.size(); ++k) {
            if (!((points[i] - points[k]).squaredNorm() < 4 * reach * reach)) {
                continue;
            }
            const Vector3d way = between(points[i], points[i + 1], points[k], points[k + 1]);
            const double distance = way.norm();
            if (!(distance < reach)) {
                continue;
            }
            m_nearest = std::min(m_nearest, distance);
            const auto last = m_last.find({i, k});
            count += last != m_last.end() && distance < tubeRadius && last->second.dot(way) < 0 ? 1 : 0;
            now.emplace(std::pair{i, k}, way);
        }
    }
    m_last = std::move(now);
    return count;
}

}  // namespace grapeshot::intestine
