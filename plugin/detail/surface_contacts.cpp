#include <grapeshot/plugin/detail/surface_pass.hpp>

#include <Eigen/Geometry>
#include <algorithm>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

namespace {

struct FloatBox {
    Eigen::Vector3f low = Eigen::Vector3f::Zero(), high = Eigen::Vector3f::Zero();
};

FloatBox boxOf(const SurfaceInStep& body, std::uint32_t t) {
    const Triangle& corners = body.triangles[t];
    FloatBox box{body.before[corners[0]], body.before[corners[0]]};
    for (const std::uint32_t v : corners) {
        box.low = box.low.cwiseMin(body.before[v]);
        box.high = box.high.cwiseMax(body.before[v]);
        if (!body.rigid) {
            box.low = box.low.cwiseMin(body.last[v]).cwiseMin(body.after[v]);
            box.high = box.high.cwiseMax(body.last[v]).cwiseMax(body.after[v]);
        }
    }
    return box;
}

}  // namespace

void SurfaceContacts::Pass::sift(std::span<const TrianglePair> pairs, std::vector<TrianglePair>& left) const {
    std::uint32_t known = noTriangle;
    FloatBox boxA;
    const float distance = static_cast<float>(m_distance) * 1.0001F;
    for (const TrianglePair& pair : pairs) {
        if (pair.triangleA != known) {
            known = pair.triangleA;
            boxA = boxOf(*m_bodies[0], known);
            boxA.low.array() -= distance;
            boxA.high.array() += distance;
        }
        const FloatBox boxB = boxOf(*m_bodies[1], pair.triangleB);
        if ((boxA.low.array() <= boxB.high.array()).all() && (boxB.low.array() <= boxA.high.array()).all()) {
            left.push_back(pair);
        }
    }
}

bool SurfaceContacts::Pass::isMisplaced(std::uint32_t face) const {
    return std::ranges::any_of(m_bodies[0]->triangles[face],
                               [&](std::uint32_t v) { return m_memory.m_anchors[0].contains(v); });
}

bool SurfaceContacts::Pass::isMisplaced(const EdgePair& ends) const {
    const auto& first = m_memory.m_anchors[0];
    const auto& second = m_memory.m_anchors[m_near != nullptr ? 0 : 1];
    return first.contains(ends[0]) || first.contains(ends[1]) ||
           (!m_bodies[1]->rigid && (second.contains(ends[2]) || second.contains(ends[3])));
}

std::array<Moving, 3> SurfaceContacts::Pass::moving(const SurfaceInStep& body, std::uint32_t face, PositionsView from,
                                                    PositionsView to) {
    const Triangle& t = body.triangles[face];
    return {Moving{at(from, t[0]), at(to, t[0])}, Moving{at(from, t[1]), at(to, t[1])},
            Moving{at(from, t[2]), at(to, t[2])}};
}

Eigen::Vector3d SurfaceContacts::Pass::normalOf(const SurfaceInStep& body, std::uint32_t face,
                                                PositionsView positions) {
    const Triangle& t = body.triangles[face];
    const Vector3d origin = at(positions, t[0]);
    return (at(positions, t[1]) - origin).cross(at(positions, t[2]) - origin).normalized();
}

std::pair<std::array<Moving, 2>, std::array<Moving, 2>> SurfaceContacts::Pass::movingEdges(const EdgePair& ends,
                                                                                           Part from, Part to) const {
    const auto one = [&](int body, std::uint32_t v) {
        return Moving{at(m_bodies[body]->*from, v), at(m_bodies[body]->*to, v)};
    };
    return {{one(0, ends[0]), one(0, ends[1])}, {one(1, ends[2]), one(1, ends[3])}};
}

Eigen::Vector3d SurfaceContacts::Pass::crossOf(const EdgePair& ends, Part part) const {
    const auto [first, second] = movingEdges(ends, part, part);
    return (first[1].to - first[0].to).cross(second[1].to - second[0].to);
}

bool SurfaceContacts::Pass::isNear(std::uint32_t vertex, const Triangle& others) const {
    return m_near != nullptr && std::ranges::any_of(others, [&](std::uint32_t other) {
               return other == vertex || std::ranges::binary_search(m_near->of(vertex), other);
           });
}

void SurfaceContacts::find(const SurfaceInStep& a, const SurfaceInStep& b, std::span<const TrianglePair> pairs,
                           double distance, const IndexLists* near, std::vector<SoftSurfaceContact>& contacts,
                           const Faced* faced) {
    Pass pass(*this, a, b, distance, near, faced);
    std::vector<TrianglePair> left;
    if (faced == nullptr) {
        pass.sift(pairs, left);
        pairs = left;
    }
    pass.lookBack(pairs);
    pass.lookAhead(pairs, contacts);
}

void SurfaceContacts::clear() {
    m_anchors[0].clear();
    m_anchors[1].clear();
    m_edges.clear();
}

std::size_t SurfaceContacts::misplaced() const {
    return m_anchors[0].size() + m_anchors[1].size() + m_edges.size();
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
