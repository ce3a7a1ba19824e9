#include <grapeshot/plugin/detail/surface_contacts.hpp>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <tuple>

#include <grapeshot/plugin/detail/feature_crossing.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

namespace {

using Eigen::Vector3d;
using PositionsView = std::span<const Eigen::Vector3f>;

Vector3d at(PositionsView positions, std::uint32_t v) {
    return positions[v].cast<double>();
}

struct Box {
    Vector3d low = Vector3d::Constant(1e300), high = Vector3d::Constant(-1e300);
    void add(const Vector3d& p) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    void add(const Moving& p) {
        add(p.from);
        add(p.to);
    }
    [[nodiscard]] bool meets(const Box& other, double distance) const {
        return ((low - other.high).array() <= distance).all() && ((other.low - high).array() <= distance).all();
    }
};

bool contains(std::span<const std::uint32_t> sorted, std::uint32_t value) {
    return std::binary_search(sorted.begin(), sorted.end(), value);
}

/// A corner beside or through a face.
struct CornerHit {
    int body = 0;                                 // whose corner
    std::uint32_t corner = 0, face = 0, own = 0;  // own: the corner's triangle
    bool crossing = false;
    double order = 0;          // time of the crossing, or the distance
    Vector3d weights, normal;  // to the corner
    double facing = 0;         // cosine of the normal and the face's
};

struct EdgeHit {
    std::array<std::uint32_t, 4> ends{};
    TrianglePair pair;
    bool crossing = false;
    double order = 0;
    double first = 0, second = 0;
    Vector3d normal;
};

}  // namespace

/// One call of `find`.
class SurfaceContacts::Pass {
  public:
    Pass(SurfaceContacts& memory, const SurfaceInStep& a, const SurfaceInStep& b, double distance,
         const IndexLists* near)
        : m_memory(memory), m_bodies{&a, &b}, m_distance(distance), m_near(near) {}

    /// Leaves the pairs whose ways in this step and the last come near each other.
    void sift(std::span<const TrianglePair> pairs, std::vector<TrianglePair>& left) const {
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

    /// What has got through since the last step?
    void lookBack(std::span<const TrianglePair> pairs) {
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

    void lookAhead(std::span<const TrianglePair> pairs, std::vector<SoftSurfaceContact>& contacts) {
        for (const TrianglePair& pair : pairs) {
            forEachCorner(pair, [&](int body, std::uint32_t corner, std::uint32_t own, std::uint32_t face) {
                if (!anchors(body).contains(corner) && !(m_bodies[body]->rigid && isMisplaced(face))) {
                    testCorner(body, corner, own, face);
                }
            });
            forEachEdgePair(pair, [&](const EdgePair& ends) {
                if (!m_memory.m_edges.contains(ends) && !isMisplaced(ends)) {
                    testEdges(pair, ends);
                }
            });
        }
        bringBack();
        chooseCorners(contacts);
        chooseEdges(contacts);
    }

  private:
    struct FloatBox {
        Eigen::Vector3f low = Eigen::Vector3f::Zero(), high = Eigen::Vector3f::Zero();
    };
    static FloatBox boxOf(const SurfaceInStep& body, std::uint32_t t) {
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

    using Part = PositionsView SurfaceInStep::*;

    template <class Wanted>
    void rememberCorners(std::span<const TrianglePair> pairs, const Wanted& wanted) {
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
    /// Is a node of the first body's face?
    [[nodiscard]] bool isMisplaced(std::uint32_t face) const {
        return std::ranges::any_of(m_bodies[0]->triangles[face],
                                   [&](std::uint32_t v) { return m_memory.m_anchors[0].contains(v); });
    }
    [[nodiscard]] bool isMisplaced(const EdgePair& ends) const {
        const auto& first = m_memory.m_anchors[0];
        const auto& second = m_memory.m_anchors[m_near != nullptr ? 0 : 1];
        return first.contains(ends[0]) || first.contains(ends[1]) ||
               (!m_bodies[1]->rigid && (second.contains(ends[2]) || second.contains(ends[3])));
    }
    [[nodiscard]] int memoryOf(int body) const { return m_near != nullptr ? 0 : body; }
    [[nodiscard]] std::map<std::uint32_t, Anchor>& anchors(int body) const {
        return m_memory.m_anchors[static_cast<std::size_t>(memoryOf(body))];
    }

    struct Foot {
        Vector3d weights = Vector3d::Zero(), between = Vector3d::Zero();
    };
    static Foot footOf(const Vector3d& point, const SurfaceInStep& body, std::uint32_t face) {
        const Triangle& t = body.triangles[face];
        const std::array<Vector3d, 3> corners{at(body.before, t[0]), at(body.before, t[1]), at(body.before, t[2])};
        const Vector3d w = nearestOn(point, corners);
        return {w, point - w[0] * corners[0] - w[1] * corners[1] - w[2] * corners[2]};
    }

    /// A corner on the wrong side of a surface slides along below it, so that it comes back where it is and not where
    /// it passed. False if it is back, or beyond the rim.
    [[nodiscard]] bool slide(int body, std::uint32_t corner, Anchor& anchor) const {
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
        return height < -0.3 * foot.between.norm();
    }

    /// Contacts of what is on the wrong side, however far.
    void bringBack() {
        for (int memory = 0; memory < 2; ++memory) {
            for (const auto& [corner, anchor] : m_memory.m_anchors[static_cast<std::size_t>(memory)]) {
                const SurfaceInStep& other = *m_bodies[1 - memory];
                const Vector3d normal = (anchor.front ? 1 : -1) * normalOf(other, anchor.face, other.after);
                m_corners.push_back({memory, corner, anchor.face, anchor.own, true, -1, anchor.weights, normal, 1});
            }
        }
        for (const auto& [ends, passed] : m_memory.m_edges) {
            const auto [first, second] = movingEdges(ends, &SurfaceInStep::after, &SurfaceInStep::after);
            if (const auto inside = nearestInside({first[0].to, first[1].to}, {second[0].to, second[1].to})) {
                const Vector3d normal = (passed.along ? 1 : -1) * crossOf(ends, &SurfaceInStep::after).normalized();
                m_edges.push_back({ends, passed.pair, true, -1, inside->x(), inside->y(), normal});
            }
        }
    }

    static std::array<Moving, 3> moving(const SurfaceInStep& body, std::uint32_t face, PositionsView from,
                                        PositionsView to) {
        const Triangle& t = body.triangles[face];
        return {Moving{at(from, t[0]), at(to, t[0])}, Moving{at(from, t[1]), at(to, t[1])},
                Moving{at(from, t[2]), at(to, t[2])}};
    }
    static Vector3d normalOf(const SurfaceInStep& body, std::uint32_t face, PositionsView positions) {
        const Triangle& t = body.triangles[face];
        const Vector3d origin = at(positions, t[0]);
        return (at(positions, t[1]) - origin).cross(at(positions, t[2]) - origin).normalized();
    }
    std::pair<std::array<Moving, 2>, std::array<Moving, 2>> movingEdges(const EdgePair& ends, Part from,
                                                                        Part to) const {
        const auto one = [&](int body, std::uint32_t v) {
            return Moving{at(m_bodies[body]->*from, v), at(m_bodies[body]->*to, v)};
        };
        return {{one(0, ends[0]), one(0, ends[1])}, {one(1, ends[2]), one(1, ends[3])}};
    }
    [[nodiscard]] Vector3d crossOf(const EdgePair& ends, Part part) const {
        const auto [first, second] = movingEdges(ends, part, part);
        return (first[1].to - first[0].to).cross(second[1].to - second[0].to);
    }
    /// Of edges that have passed; 0 if they are beside each other now.
    [[nodiscard]] double gapOf(const EdgePair& ends, bool along) const {
        const auto [first, second] = movingEdges(ends, &SurfaceInStep::before, &SurfaceInStep::before);
        const auto inside = nearestInside({first[0].to, first[1].to}, {second[0].to, second[1].to});
        if (!inside) {
            return 0;
        }
        const Vector3d between = first[0].to + inside->x() * (first[1].to - first[0].to) - second[0].to -
                                 inside->y() * (second[1].to - second[0].to);
        return (along ? 1 : -1) * between.dot(crossOf(ends, &SurfaceInStep::before));
    }

    template <class First, class Second>
    [[nodiscard]] bool meet(const First& first, const Second& second, double distance = 0) const {
        const auto boxOf = [](const auto& points) {
            Box box;
            if constexpr (requires { points.size(); }) {
                for (const Moving& point : points) {
                    box.add(point);
                }
            } else {
                box.add(points);
            }
            return box;
        };
        return boxOf(first).meets(boxOf(second), distance + 1e-9);
    }

    template <class Run>
    void forEachCorner(const TrianglePair& pair, const Run& run) const {
        const std::array<std::uint32_t, 2> triangles{pair.triangleA, pair.triangleB};
        for (int body = 0; body < 2; ++body) {
            const SurfaceInStep& own = *m_bodies[body];
            const std::uint32_t t = triangles[static_cast<std::size_t>(body)];
            const std::uint32_t face = triangles[static_cast<std::size_t>(1 - body)];
            if (m_bodies[1 - body]->thread) {
                continue;
            }
            for (std::uint32_t i = 0; i < (own.thread ? 2U : 3U); ++i) {
                const std::uint32_t corner = own.triangles[t][i];
                if (((*own.owners)[t] & (1U << i)) != 0 && !isNear(corner, m_bodies[1 - body]->triangles[face])) {
                    run(body, corner, t, face);
                }
            }
        }
    }
    template <class Run>
    void forEachEdgePair(const TrianglePair& pair, const Run& run) const {
        const auto forEdges = [&](int body, std::uint32_t t, const auto& use) {
            const SurfaceInStep& surface = *m_bodies[body];
            for (std::uint32_t i = 0; i < (surface.thread ? 1U : 3U); ++i) {
                if (((*surface.owners)[t] & (8U << i)) != 0) {
                    use(std::min(surface.triangles[t][i], surface.triangles[t][(i + 1) % 3]),
                        std::max(surface.triangles[t][i], surface.triangles[t][(i + 1) % 3]));
                }
            }
        };
        forEdges(0, pair.triangleA, [&](std::uint32_t a0, std::uint32_t a1) {
            forEdges(1, pair.triangleB, [&](std::uint32_t b0, std::uint32_t b1) {
                const Triangle second{b0, b1, b1};
                if (!isNear(a0, second) && !isNear(a1, second)) {
                    run(EdgePair{a0, a1, b0, b1});
                }
            });
        });
    }
    /// On the surface of one body.
    [[nodiscard]] bool isNear(std::uint32_t vertex, const Triangle& others) const {
        return m_near != nullptr && std::ranges::any_of(others, [&](std::uint32_t other) {
                   return other == vertex || contains(m_near->of(vertex), other);
               });
    }

    void testCorner(int body, std::uint32_t corner, std::uint32_t own, std::uint32_t face) {
        const SurfaceInStep& mine = *m_bodies[body];
        const SurfaceInStep& other = *m_bodies[1 - body];
        const Moving point = {at(mine.before, corner), at(mine.after, corner)};
        const auto triangle = moving(other, face, other.before, other.after);
        if (!meet(point, triangle, m_distance)) {
            return;
        }
        if (const auto crossing = crossingOf(point, triangle)) {
            m_corners.push_back(
                {body, corner, face, own, true, crossing->time, crossing->weights, crossing->normal, 1});
            return;
        }
        const std::array<Vector3d, 3> end{triangle[0].to, triangle[1].to, triangle[2].to};
        const Vector3d weights = nearestOn(point.to, end);
        const Vector3d between = point.to - weights[0] * end[0] - weights[1] * end[1] - weights[2] * end[2];
        const double distance = between.norm();
        if (distance < m_distance && distance > 1e-12) {
            const Vector3d normal = between / distance;
            const double facing = normal.dot((end[1] - end[0]).cross(end[2] - end[0]).normalized());
            m_corners.push_back({body, corner, face, own, false, distance, weights, normal, facing});
        }
    }

    void testEdges(const TrianglePair& pair, const EdgePair& ends) {
        const auto [first, second] = movingEdges(ends, &SurfaceInStep::before, &SurfaceInStep::after);
        if (!meet(first, second, m_distance)) {
            return;
        }
        if (const auto crossing = crossingOf(first, second)) {
            m_edges.push_back({ends, pair, true, crossing->time, crossing->first, crossing->second, crossing->normal});
            return;
        }
        const auto inside = nearestInside({first[0].to, first[1].to}, {second[0].to, second[1].to});
        if (!inside) {
            return;
        }
        const Vector3d between = first[0].to + inside->x() * (first[1].to - first[0].to) - second[0].to -
                                 inside->y() * (second[1].to - second[0].to);
        const double distance = between.norm();
        // Corners hold the full distance; between them edges and faces may come a little nearer.
        if (distance < slackened * m_distance && distance > 1e-12) {
            m_edges.push_back({ends, pair, false, distance, inside->x(), inside->y(), between / distance});
        }
    }

    void chooseCorners(std::vector<SoftSurfaceContact>& contacts) {
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

    void chooseOfCorner(std::span<CornerHit> hits, std::vector<CornerHit>& chosen) {
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

    void chooseEdges(std::vector<SoftSurfaceContact>& contacts) {
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

    /// Distance of corner and face at the end of the step, along the normal.
    [[nodiscard]] double endOf(const CornerHit& hit) const {
        const SurfaceInStep& other = *m_bodies[1 - hit.body];
        const Triangle& t = other.triangles[hit.face];
        Vector3d between = at(m_bodies[hit.body]->after, hit.corner);
        for (int i = 0; i < 3; ++i) {
            between -= hit.weights[i] * at(other.after, t[i]);
        }
        return between.dot(hit.normal);
    }

    void emit(const CornerHit& hit, std::vector<SoftSurfaceContact>& contacts) const {
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

    void measure(SoftSurfaceContact& contact, std::vector<SoftSurfaceContact>& contacts) const {
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

    static constexpr double slackened = 0.75;

    SurfaceContacts& m_memory;
    std::array<const SurfaceInStep*, 2> m_bodies;
    double m_distance;
    const IndexLists* m_near;
    std::vector<CornerHit> m_corners;
    std::vector<EdgeHit> m_edges;
    std::vector<std::pair<int, std::uint32_t>> m_passing;
};

void SurfaceContacts::find(const SurfaceInStep& a, const SurfaceInStep& b, std::span<const TrianglePair> pairs,
                           double distance, const IndexLists* near, std::vector<SoftSurfaceContact>& contacts) {
    Pass pass(*this, a, b, distance, near);
    std::vector<TrianglePair> left;
    pass.sift(pairs, left);
    pass.lookBack(left);
    pass.lookAhead(left, contacts);
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
