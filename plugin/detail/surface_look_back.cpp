#include <grapeshot/plugin/detail/surface_pass.hpp>

#include <Eigen/Geometry>
#include <algorithm>
#include <iterator>
#include <optional>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

SurfaceContacts::Pass::Foot SurfaceContacts::Pass::footOf(const Vector3d& point, const SurfaceInStep& body,
                                                          std::uint32_t face) {
    const Triangle& t = body.triangles[face];
    const std::array<Vector3d, 3> corners{at(body.before, t[0]), at(body.before, t[1]), at(body.before, t[2])};
    const Vector3d w = nearestOn(point, corners);
    return {w, point - w[0] * corners[0] - w[1] * corners[1] - w[2] * corners[2]};
}

bool SurfaceContacts::Pass::slide(int body, std::uint32_t corner, Anchor& anchor) const {
    constexpr int longestWay = 64;
    const SurfaceInStep& other = *m_bodies[1 - body];
    const Vector3d point = at(m_bodies[body]->before, corner);
    Foot foot = footOf(point, other, anchor.face);
    for (int i = 0; i < longestWay; ++i) {
        const std::uint32_t from = anchor.face;
        const Vector3d normal = normalOf(other, from, other.before);
        for (const std::uint32_t v : other.triangles[from]) {
            for (const std::uint32_t next : other.surface->fan.of(v)) {
                const Foot there = footOf(point, other, next);
                if (there.between.squaredNorm() < foot.between.squaredNorm() * (1 - 1e-9) &&
                    normalOf(other, next, other.before).dot(normal) > 0.3) {
                    anchor.face = next;
                    foot = there;
                }
            }
        }
        if (anchor.face == from) {
            break;
        }
    }
    anchor.weights = foot.weights;
    const double height = (anchor.front ? 1 : -1) * foot.between.dot(normalOf(other, anchor.face, other.before));
    return height < -0.3 * foot.between.norm() || isInSoftSolid(body, corner);
}

bool SurfaceContacts::Pass::isInSoftSolid(int body, std::uint32_t corner) const {
    const SurfaceInStep& other = *m_bodies[1 - body];
    if (!m_bodies[body]->rigid || !other.solid) {
        return false;
    }
    // By the faces above: those that the vertical line through the corner crosses.
    const Vector3d point = at(m_bodies[body]->before, corner);
    int above = 0;
    for (const Triangle& t : other.triangles) {
        const Vector3d a = at(other.before, t[0]) - point;
        const Vector3d b = at(other.before, t[1]) - point;
        const Vector3d c = at(other.before, t[2]) - point;
        const double ab = a.x() * b.z() - a.z() * b.x();
        const double bc = b.x() * c.z() - b.z() * c.x();
        const double ca = c.x() * a.z() - c.z() * a.x();
        if ((ab > 0) == (bc > 0) && (bc > 0) == (ca > 0)) {
            above += (bc * a.y() + ca * b.y() + ab * c.y()) * (ab > 0 ? 1 : -1) > 0 ? 1 : 0;
        }
    }
    return above % 2 == 1;
}

void SurfaceContacts::Pass::spreadInSoftSolid() {
    if (!m_bodies[1]->rigid || !m_bodies[0]->solid) {
        return;
    }
    auto& known = anchors(1);
    std::vector<std::uint32_t> front;
    for (const auto& [corner, anchor] : known) {
        front.push_back(corner);
    }
    std::vector<std::uint32_t> outside;  // ascending
    while (!front.empty()) {
        const std::uint32_t from = front.back();
        front.pop_back();
        for (const std::uint32_t corner : m_bodies[1]->surface->ring.of(from)) {
            const auto place = std::ranges::lower_bound(outside, corner);
            if (known.contains(corner) || (place != outside.end() && *place == corner)) {
                continue;
            }
            Anchor anchor = known.at(from);
            anchor.own = m_bodies[1]->surface->fan.of(corner).front();
            anchor.front = true;
            if (isInSoftSolid(1, corner)) {
                static_cast<void>(slide(1, corner, anchor));
                known.emplace(corner, anchor);
                front.push_back(corner);
            } else {
                outside.insert(place, corner);
            }
        }
    }
}

double SurfaceContacts::Pass::gapOf(const EdgePair& ends, bool along) const {
    const auto [first, second] = movingEdges(ends, &SurfaceInStep::before, &SurfaceInStep::before);
    const auto inside = nearestInside({first[0].to, first[1].to}, {second[0].to, second[1].to});
    if (!inside) {
        return 0;
    }
    const Vector3d between = first[0].to + inside->x() * (first[1].to - first[0].to) - second[0].to -
                             inside->y() * (second[1].to - second[0].to);
    return (along ? 1 : -1) * between.dot(crossOf(ends, &SurfaceInStep::before));
}

template <class Wanted>
void SurfaceContacts::Pass::rememberCorners(std::span<const TrianglePair> pairs, const Wanted& wanted) {
    std::array<std::map<std::uint32_t, Anchor>, 2> passed;
    for (const TrianglePair& pair : pairs) {
        forEachCorner(pair, [&](int body, std::uint32_t corner, std::uint32_t own, std::uint32_t face) {
            const SurfaceInStep& mine = *m_bodies[body];
            const SurfaceInStep& other = *m_bodies[1 - body];
            if (!wanted(body) || anchors(body).contains(corner) || (mine.rigid && isMisplaced(face))) {
                return;
            }
            const Moving point = {at(mine.last, corner), at(mine.before, corner)};
            const auto triangle = moving(other, face, other.last, other.before);
            const auto crossing = meet(point, triangle) ? crossingOf(point, triangle) : std::nullopt;
            if (crossing) {
                Anchor& anchor = passed[static_cast<std::size_t>(memoryOf(body))][corner];
                if (crossing->time < anchor.time) {
                    anchor = {own, face, crossing->weights,
                              crossing->normal.dot(normalOf(other, face, other.before)) > 0, crossing->time};
                }
            }
        });
    }
    for (int body = 0; body < 2; ++body) {
        for (auto& [corner, anchor] : passed[static_cast<std::size_t>(body)]) {
            if (slide(body, corner, anchor)) {
                anchors(body).emplace(corner, anchor);
            }
        }
    }
}

void SurfaceContacts::Pass::lookBack(std::span<const TrianglePair> pairs) {
    for (int body = 0; body < (m_near != nullptr ? 1 : 2); ++body) {
        for (auto known = anchors(body).begin(); known != anchors(body).end();) {
            known = slide(body, known->first, known->second) ? std::next(known) : anchors(body).erase(known);
        }
    }
    std::erase_if(m_memory.m_edges, [&](const auto& known) { return gapOf(known.first, known.second.along) >= 0; });
    // Nodes first: where they are on the wrong side, faces and edges between them are, too, and nothing is learnt
    // from what those pass.
    const bool first = !m_bodies[1]->rigid;
    rememberCorners(pairs, [&](int body) { return body == 0 || first; });
    if (!first) {
        rememberCorners(pairs, [&](int body) { return body == 1; });
        spreadInSoftSolid();
    }
    for (const TrianglePair& pair : pairs) {
        forEachEdgePair(pair, [&](const EdgePair& ends) {
            if (m_memory.m_edges.contains(ends) || isMisplaced(ends)) {
                return;
            }
            const auto [one, other] = movingEdges(ends, &SurfaceInStep::last, &SurfaceInStep::before);
            const auto crossing = meet(one, other) ? crossingOf(one, other) : std::nullopt;
            if (crossing) {
                m_memory.m_edges[ends] = {crossing->normal.dot(crossOf(ends, &SurfaceInStep::before)) > 0, pair};
            }
        });
    }
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
