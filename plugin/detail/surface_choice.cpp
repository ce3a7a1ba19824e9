#include <grapeshot/plugin/detail/surface_pass.hpp>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <tuple>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

double SurfaceContacts::Pass::endOf(const CornerHit& hit) const {
    const SurfaceInStep& other = *m_bodies[1 - hit.body];
    const Triangle& t = other.triangles[hit.face];
    Vector3d between = at(m_bodies[hit.body]->after, hit.corner);
    for (int i = 0; i < 3; ++i) {
        between -= hit.weights[i] * at(other.after, t[i]);
    }
    return between.dot(hit.normal);
}

void SurfaceContacts::Pass::measure(SoftSurfaceContact& contact, std::vector<SoftSurfaceContact>& contacts) const {
    const auto gap = [&](Part part) {
        Vector3d between = Vector3d::Zero();
        for (int i = 0; i < 3; ++i) {
            between += contact.weightsA[i] * at(m_bodies[0]->*part, contact.a[i]) -
                       contact.weightsB[i] * at(m_bodies[1]->*part, contact.b[i]);
        }
        return static_cast<float>(between.dot(contact.normal.cast<double>()));
    };
    contact.before = gap(&SurfaceInStep::before);
    contact.after = gap(&SurfaceInStep::after);
    if (contact.after < static_cast<float>(m_distance)) {
        contacts.push_back(contact);
    }
}

void SurfaceContacts::Pass::emit(const CornerHit& hit, std::vector<SoftSurfaceContact>& contacts) const {
    SoftSurfaceContact contact;
    const std::array<std::uint32_t, 3> corner{hit.corner, hit.corner, hit.corner};
    const Eigen::Vector3f one(1, 0, 0);
    const Triangle& face = m_bodies[1 - hit.body]->triangles[hit.face];
    const bool isA = hit.body == 0;
    contact.a = isA ? corner : face;
    contact.b = isA ? face : corner;
    contact.weightsA = isA ? one : Eigen::Vector3f(hit.weights.cast<float>());
    contact.weightsB = isA ? Eigen::Vector3f(hit.weights.cast<float>()) : one;
    contact.normal = (isA ? 1.0F : -1.0F) * hit.normal.cast<float>();
    contact.features = isA ? Features::cornerFace : Features::faceCorner;
    contact.crossing = hit.crossing;
    contact.pair = isA ? TrianglePair{hit.own, hit.face} : TrianglePair{hit.face, hit.own};
    measure(contact, contacts);
}

void SurfaceContacts::Pass::chooseOfCorner(std::span<CornerHit> hits, std::vector<CornerHit>& chosen) {
    if (hits.front().crossing) {
        m_passing.push_back({hits.front().body, hits.front().corner});
        chosen.push_back(hits.front());
        return;
    }
    const SurfaceInStep& other = *m_bodies[1 - hits.front().body];
    if (other.solid) {
        // Of several faces at the same distance the one that is seen straightest knows the side.
        const double nearest = hits.front().order * (1 + 1e-6) + 1e-9;
        CornerHit best = hits.front();
        for (const CornerHit& hit : hits) {
            best = hit.order <= nearest && std::abs(hit.facing) > std::abs(best.facing) ? hit : best;
        }
        if (best.facing < 0) {
            best.normal = -best.normal;
            chosen.push_back(best);
            return;
        }
    }
    const std::size_t first = chosen.size();
    for (const CornerHit& hit : hits) {
        const bool isNew = std::all_of(chosen.begin() + static_cast<std::ptrdiff_t>(first), chosen.end(),
                                       [&](const CornerHit& known) { return known.normal.dot(hit.normal) < 0.8; });
        const bool near = !m_bodies[hit.body]->rigid || hit.order < slackened * m_distance;
        if (isNew && near && chosen.size() < first + 3) {
            chosen.push_back(hit);
        }
    }
}

void SurfaceContacts::Pass::chooseCorners(std::vector<SoftSurfaceContact>& contacts) {
    std::ranges::sort(m_corners, {}, [](const CornerHit& hit) {
        return std::tuple(hit.body, hit.corner, !hit.crossing, hit.order, hit.face);
    });
    std::vector<CornerHit> chosen;
    for (std::size_t begin = 0; begin < m_corners.size();) {
        std::size_t end = begin;
        while (end < m_corners.size() && m_corners[end].corner == m_corners[begin].corner &&
               m_corners[end].body == m_corners[begin].body) {
            ++end;
        }
        chooseOfCorner({m_corners.data() + begin, end - begin}, chosen);
        begin = end;
    }
    // Of a fine rigid mesh behind a coarse face two are enough.
    const auto ofFace = [&](const CornerHit& hit) { return m_bodies[hit.body]->rigid; };
    std::ranges::stable_sort(chosen, {}, [&](const CornerHit& hit) {
        return ofFace(hit) ? std::tuple(true, hit.face, endOf(hit)) : std::tuple(false, 0U, 0.0);
    });
    std::size_t same = 0;
    for (std::size_t i = 0; i < chosen.size(); ++i) {
        const bool sameFace =
            i > 0 && ofFace(chosen[i]) && ofFace(chosen[i - 1]) && chosen[i].face == chosen[i - 1].face;
        same = sameFace ? same + 1 : 0;
        if (same < (chosen[i].crossing ? 4U : 2U)) {
            emit(chosen[i], contacts);
        }
    }
}

void SurfaceContacts::Pass::chooseEdges(std::vector<SoftSurfaceContact>& contacts) {
    std::ranges::sort(m_edges, {}, [](const EdgeHit& hit) {
        return std::tuple(hit.ends[0], hit.ends[1], !hit.crossing, hit.order, hit.ends[2], hit.ends[3]);
    });
    std::ranges::sort(m_passing);
    const auto passes = [&](int body, std::uint32_t corner) {
        return std::ranges::binary_search(m_passing, std::pair(body, corner));
    };
    const EdgeHit* last = nullptr;
    for (const EdgeHit& hit : m_edges) {
        const bool same = last != nullptr && last->ends[0] == hit.ends[0] && last->ends[1] == hit.ends[1];
        // Beside a corner that passes through, nobody knows the side of what is merely near.
        const bool doubtful = !hit.crossing && (passes(0, hit.ends[0]) || passes(0, hit.ends[1]) ||
                                                passes(1, hit.ends[2]) || passes(1, hit.ends[3]));
        if (same || doubtful) {
            continue;
        }
        last = &hit;
        SoftSurfaceContact contact;
        contact.a = {hit.ends[0], hit.ends[1], hit.ends[1]};
        contact.b = {hit.ends[2], hit.ends[3], hit.ends[3]};
        contact.weightsA = Eigen::Vector3d(1 - hit.first, hit.first, 0).cast<float>();
        contact.weightsB = Eigen::Vector3d(1 - hit.second, hit.second, 0).cast<float>();
        contact.normal = hit.normal.cast<float>();
        contact.features = Features::edges;
        contact.crossing = hit.crossing;
        contact.pair = hit.pair;
        measure(contact, contacts);
    }
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
