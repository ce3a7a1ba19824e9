#include <algorithm>
#include <optional>

#include <grapeshot/adb/point_query.hpp>
#include <grapeshot/narrowphase/penetration.hpp>

namespace grapeshot {
namespace {

constexpr std::size_t mostProbes = 32;  // vertices of which the nearest to the outside is taken

/// Is the inner mesh's box, moved, within the outer's?
bool boxInside(const Tree& inner, const Pose& innerInOuter, const Tree& outer) {
    const Eigen::Vector3f center = apply(innerInOuter, 0.5F * (inner.lower + inner.upper));
    const Eigen::Vector3f half = 0.5F * (innerInOuter.rotation.cwiseAbs() * (inner.upper - inner.lower));
    // A body inside another may be turned, so that its turned box sticks out: the middle tells well enough, the
    // vertices are asked anyway.
    return (center.array() >= outer.lower.array()).all() && (center.array() <= outer.upper.array()).all() &&
           (half.array() <= (outer.upper - outer.lower).array()).all();
}

/// One vertex of each connected piece.
void pieceVertices(const MeshModel& mesh, std::vector<std::uint32_t>& vertices) {
    thread_local std::vector<char> reached;
    thread_local std::vector<std::uint32_t> queue;
    vertices.clear();
    const Topology& topology = mesh.topology;
    if (mesh.report.pieces <= 1) {
        vertices.push_back(mesh.tree.triangles.front()[0]);
        return;
    }
    reached.assign(topology.welded.size(), 0);
    for (const Triangle& triangle : mesh.tree.triangles) {
        const std::uint32_t seed = topology.welded[triangle[0]];
        if (reached[seed] != 0) {
            continue;
        }
        vertices.push_back(seed);
        reached[seed] = 1;
        queue.assign(1, seed);
        while (!queue.empty()) {
            const std::uint32_t vertex = queue.back();
            queue.pop_back();
            for (const std::uint32_t neighbour : topology.ringOf(vertex)) {
                if (reached[neighbour] == 0) {
                    reached[neighbour] = 1;
                    queue.push_back(neighbour);
                }
            }
        }
    }
}

struct WayOut {
    Eigen::Vector3f from;  ///< vertex of the inner mesh, outer's frame
    ClosestPoint to;
};

/// If some piece of the inner mesh is inside the outer solid: the shortest way out of a vertex of it.
std::optional<WayOut> wayOut(const MeshModel& inner, const Pose& innerInOuter, const MeshModel& outer) {
    thread_local std::vector<std::uint32_t> pieces;
    if (!outer.solid || !boxInside(inner.tree, innerInOuter, outer.tree)) {
        return std::nullopt;
    }
    pieceVertices(inner, pieces);
    const bool contained = std::any_of(pieces.begin(), pieces.end(), [&](std::uint32_t vertex) {
        return contains(outer.tree, apply(innerInOuter, inner.tree.vertices[vertex]));
    });
    if (!contained) {
        return std::nullopt;
    }
    const std::size_t triangles = inner.tree.triangles.size();
    const std::size_t stride = std::max<std::size_t>(1, triangles / mostProbes);
    const float reach = (outer.tree.upper - outer.tree.lower).norm();
    std::optional<WayOut> best;
    const auto probe = [&](std::uint32_t vertex) {
        const Eigen::Vector3f point = apply(innerInOuter, inner.tree.vertices[vertex]);
        const auto closest = closestPoint(outer.tree, point, best ? best->to.distance : reach);
        if (closest && (!best || closest->distance < best->to.distance) && contains(outer.tree, point)) {
            best = WayOut{point, *closest};
        }
    };
    for (const std::uint32_t vertex : pieces) {
        probe(vertex);
    }
    for (std::size_t t = 0; t < triangles; t += stride) {
        probe(inner.tree.triangles[t][0]);
    }
    return best && best->to.distance > 0 ? best : std::nullopt;
}

std::uint32_t triangleAt(const Tree& tree, const Eigen::Vector3f& point) {
    // A vertex that went there and back is off by rounding.
    const float slack = 1e-5F * (tree.upper - tree.lower).norm();
    const auto own = closestPoint(tree, point, slack);
    return own ? own->triangle : noTriangle;
}

}  // namespace

void containmentContacts(const MeshModel& a, const MeshModel& b, const Pose& bInA, std::vector<SurfaceContact>& out) {
    if (const auto way = wayOut(b, bInA, a)) {
        SurfaceContact contact;
        contact.onB = way->from;
        contact.onA = way->to.point;
        contact.normal = (contact.onB - contact.onA).normalized();
        contact.signedDistance = -way->to.distance;
        contact.triangleA = way->to.triangle;
        contact.triangleB = triangleAt(b.tree, apply(inverse(bInA), contact.onB));
        out.push_back(contact);
    }
    if (const auto way = wayOut(a, inverse(bInA), b)) {
        SurfaceContact contact;
        contact.onA = apply(bInA, way->from);
        contact.onB = apply(bInA, way->to.point);
        contact.normal = (contact.onB - contact.onA).normalized();
        contact.signedDistance = -way->to.distance;
        contact.triangleA = triangleAt(a.tree, contact.onA);
        contact.triangleB = way->to.triangle;
        out.push_back(contact);
    }
}

}  // namespace grapeshot
