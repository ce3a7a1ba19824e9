#include <grapeshot/narrowphase/detail/cut_depth.hpp>

#include <algorithm>
#include <optional>
#include <utility>

#include <grapeshot/adb/point_query.hpp>

namespace grapeshot::detail {
namespace {

constexpr std::size_t mostVisited = 256;
constexpr std::size_t mostMeasured = 16;

/// Marks on vertices that need no clearing between uses.
class Marks {
  public:
    void reset(std::size_t count) {
        if (m_mark.size() < count) {
            m_mark.resize(count, 0);
        }
        if (m_now > 0xfffffff0U) {
            std::fill(m_mark.begin(), m_mark.end(), 0U);
            m_now = 0;
        }
        m_now += 4;
    }
    void block(std::uint32_t vertex) { set(vertex, 1); }
    void visit(std::uint32_t vertex) { set(vertex, 2); }
    [[nodiscard]] bool isBlocked(std::uint32_t vertex) const { return (bits(vertex) & 1U) != 0; }
    [[nodiscard]] bool isVisited(std::uint32_t vertex) const { return (bits(vertex) & 2U) != 0; }

  private:
    [[nodiscard]] std::uint32_t bits(std::uint32_t vertex) const {
        return m_mark[vertex] > m_now ? m_mark[vertex] - m_now : 0;
    }
    void set(std::uint32_t vertex, std::uint32_t bit) { m_mark[vertex] = m_now + (bits(vertex) | bit); }

    std::vector<std::uint32_t> m_mark;
    std::uint32_t m_now = 0;
};

using Keyed = std::pair<float, std::uint32_t>;  // how deep, vertex

/// Vertices of one mesh behind the other's surface, deepest along `inwards` (mesh frame) first.
void visitInside(const MeshModel& mesh, bool isA, std::span<const CutPiece> pieces, const Eigen::Vector3f& inwards,
                 std::vector<Keyed>& visited) {
    thread_local Marks marks;
    thread_local std::vector<Keyed> heap;
    marks.reset(mesh.tree.vertices.size());
    heap.clear();
    visited.clear();
    const auto cornersInside = [&](const CutPiece& piece, auto&& use) {
        const Triangle& corners = mesh.tree.triangles[isA ? piece.pair.triangleA : piece.pair.triangleB];
        const unsigned inside = isA ? piece.segment.insideA : piece.segment.insideB;
        for (std::size_t i = 0; i < 3 && piece.hasSegment; ++i) {
            use(mesh.topology.welded[corners[i]], (inside >> i & 1U) != 0);
        }
    };
    // The flood must not leave over a crossing triangle's outer corners. A corner that one pair calls inside and
    // another outside (an edge of the other mesh is near) is measured, since the ray decides, but not passed.
    for (const CutPiece& piece : pieces) {
        cornersInside(piece, [&](std::uint32_t vertex, bool inside) {
            if (!inside) {
                marks.block(vertex);
            }
        });
    }
    const auto push = [&](std::uint32_t vertex) {
        marks.visit(vertex);
        heap.emplace_back(inwards.dot(mesh.tree.vertices[vertex]), vertex);
        std::push_heap(heap.begin(), heap.end());
    };
    for (const CutPiece& piece : pieces) {
        cornersInside(piece, [&](std::uint32_t vertex, bool inside) {
            if (inside && !marks.isVisited(vertex)) {
                push(vertex);
            }
        });
    }
    while (!heap.empty() && visited.size() < mostVisited) {
        std::pop_heap(heap.begin(), heap.end());
        const Keyed deepest = heap.back();
        heap.pop_back();
        visited.push_back(deepest);
        if (marks.isBlocked(deepest.second)) {
            continue;
        }
        for (const std::uint32_t neighbour : mesh.topology.ringOf(deepest.second)) {
            if (!marks.isVisited(neighbour) && !marks.isBlocked(neighbour)) {
                push(neighbour);
            }
        }
    }
    std::sort(visited.begin(), visited.end(), [](const Keyed& left, const Keyed& right) {
        return left.first != right.first ? left.first > right.first : left.second < right.second;
    });
}

/// The deepest, and of the others the deep ones that are apart from those taken.
void thin(const MeshModel& mesh, float spread, std::vector<Keyed>& visited) {
    std::size_t taken = 0;
    for (const Keyed& candidate : visited) {
        const Eigen::Vector3f& point = mesh.tree.vertices[candidate.second];
        const bool apart =
            std::all_of(visited.begin(), visited.begin() + static_cast<std::ptrdiff_t>(taken), [&](const Keyed& other) {
                return (mesh.tree.vertices[other.second] - point).squaredNorm() >= spread * spread;
            });
        if (apart) {
            visited[taken++] = candidate;
        }
        if (taken == mostMeasured) {
            break;
        }
    }
    visited.resize(taken);
}

/// Way out of the solid from a point inside it.
std::optional<RayHit> wayOut(const Tree& tree, const Eigen::Vector3f& from, const Eigen::Vector3f& direction) {
    const float reach = 1.01F * (tree.upper - tree.lower).norm();
    const auto hit = castRay(tree, from, direction, reach);
    return hit && hit->backFace ? hit : std::nullopt;
}

/// The column through a point: A's vertex (way out of B only), B's vertex (way out of A only), or a point inside both.
enum class Column { vertexOfA, vertexOfB, inside };

std::optional<SurfaceContact> measure(const MeshModel& a, const MeshModel& b, const Pose& bInA,
                                      const Eigen::Vector3f& normal, const Eigen::Vector3f& pointInA,
                                      const Eigen::Vector3f& pointInB, Column kind) {
    SurfaceContact contact;
    contact.normal = normal;
    float up = 0, down = 0;
    if (kind != Column::vertexOfB) {
        const auto hit = wayOut(b.tree, pointInB, bInA.rotation.transpose() * normal);
        if (!hit) {
            return std::nullopt;
        }
        up = hit->t;
        contact.triangleB = hit->triangle;
    }
    if (kind != Column::vertexOfA) {
        const auto hit = wayOut(a.tree, pointInA, -normal);
        if (!hit) {
            return std::nullopt;
        }
        down = hit->t;
        contact.triangleA = hit->triangle;
    }
    contact.onA = pointInA - normal * down;
    contact.onB = pointInA + normal * up;
    contact.signedDistance = -(up + down);
    return contact;
}

}  // namespace

void measureColumns(const MeshModel& a, const MeshModel& b, const Pose& bInA, const SurfaceCut& cut,
                    std::span<const CutPiece> pieces, float spread, std::vector<SurfaceContact>& out) {
    thread_local std::vector<Keyed> visited;
    const Eigen::Vector3f normal = cut.normal.cast<float>().normalized();
    const Pose aInB = inverse(bInA);
    const std::size_t before = out.size();

    visitInside(a, true, pieces, -normal, visited);
    thin(a, spread, visited);
    for (const auto& [key, vertex] : visited) {
        const Eigen::Vector3f& point = a.tree.vertices[vertex];
        if (auto contact = measure(a, b, bInA, normal, point, apply(aInB, point), Column::vertexOfA)) {
            const auto own = closestPoint(a.tree, point, 0);
            contact->triangleA = own ? own->triangle : noTriangle;
            out.push_back(*contact);
        }
    }
    visitInside(b, false, pieces, bInA.rotation.transpose() * normal, visited);
    thin(b, spread, visited);
    for (const auto& [key, vertex] : visited) {
        const Eigen::Vector3f& point = b.tree.vertices[vertex];
        if (auto contact = measure(a, b, bInA, normal, apply(bInA, point), point, Column::vertexOfB)) {
            const auto own = closestPoint(b.tree, point, 0);
            contact->triangleB = own ? own->triangle : noTriangle;
            out.push_back(*contact);
        }
    }
    if (out.size() > before) {
        return;
    }
    const auto inside = [&](const Eigen::Vector3f& point) {
        if (const auto contact = measure(a, b, bInA, normal, point, apply(aInB, point), Column::inside)) {
            out.push_back(*contact);
        }
    };
    const Eigen::Vector3f center = cut.center.cast<float>();
    inside(center);
    const std::size_t stride = std::max<std::size_t>(1, pieces.size() / mostMeasured);
    for (std::size_t i = 0; i < pieces.size(); i += stride) {
        inside(0.5F * (center + pieces[i].middle));
    }
}

}  // namespace grapeshot::detail
