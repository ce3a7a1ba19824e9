#include <grapeshot/scf/reference/convex_polyhedron.hpp>

#include <Eigen/Geometry>

#include <grapeshot/core/mesh_report.hpp>
#include <grapeshot/core/topology.hpp>

namespace grapeshot::scf::reference {

namespace {

using Eigen::Vector3d;

std::string facePlace(std::size_t face) {
    return "triangle " + std::to_string(face);
}

void addVertices(MeshView mesh, const Topology& topology, ConvexPolyhedron& body) {
    std::vector<std::uint32_t> index(mesh.vertices.size(), noNeighbour);
    for (const Triangle& triangle : mesh.triangles) {
        ConvexPolyhedron::Face face{};
        for (std::size_t c = 0; c < 3; ++c) {
            std::uint32_t& known = index[topology.welded[triangle[c]]];
            if (known == noNeighbour) {
                known = static_cast<std::uint32_t>(body.vertices.size());
                body.vertices.push_back(mesh.vertices[triangle[c]].cast<double>());
            }
            face.corners[c] = known;
        }
        body.faces.push_back(face);
    }
    Vector3d lower = body.vertices.front();
    Vector3d upper = lower;
    for (const Vector3d& vertex : body.vertices) {
        lower = lower.cwiseMin(vertex);
        upper = upper.cwiseMax(vertex);
    }
    body.size = (upper - lower).norm();
}

void addEdges(const Topology& topology, ConvexPolyhedron& body) {
    for (std::uint32_t f = 0; f < body.faces.size(); ++f) {
        for (std::size_t e = 0; e < 3; ++e) {
            const std::uint32_t other = topology.across[f][e];
            if (other == noNeighbour) {
                throw NotConvex(NotConvexReason::open, facePlace(f));
            }
            if (other < f) {
                continue;
            }
            const auto edge = static_cast<std::uint32_t>(body.edges.size());
            body.edges.push_back({{body.faces[f].corners[e], body.faces[f].corners[(e + 1) % 3]}, {f, other}});
            body.faces[f].edges[e] = edge;
            for (std::size_t back = 0; back < 3; ++back) {
                if (topology.across[other][back] == f && body.faces[other].corners[back] == body.edges.back().ends[1]) {
                    body.faces[other].edges[back] = edge;
                }
            }
        }
    }
    body.edgesBegin.assign(body.vertices.size() + 1, 0);
    for (const ConvexPolyhedron::Edge& edge : body.edges) {
        for (const std::uint32_t end : edge.ends) {
            ++body.edgesBegin[end + 1];
        }
    }
    for (std::size_t v = 0; v < body.vertices.size(); ++v) {
        body.edgesBegin[v + 1] += body.edgesBegin[v];
    }
    body.edgesAround.resize(body.edgesBegin.back());
    std::vector<std::uint32_t> next(body.edgesBegin.begin(), body.edgesBegin.end() - 1);
    for (std::uint32_t e = 0; e < body.edges.size(); ++e) {
        for (const std::uint32_t end : body.edges[e].ends) {
            body.edgesAround[next[end]++] = e;
        }
    }
}

/// Convex at every edge and closed is convex, piece by piece.
void requireConvex(const ConvexPolyhedron& body) {
    std::vector<Vector3d> normals;
    for (std::size_t f = 0; f < body.faces.size(); ++f) {
        const auto& corners = body.faces[f].corners;
        const Vector3d& a = body.vertices[corners[0]];
        const Vector3d& b = body.vertices[corners[1]];
        const Vector3d& c = body.vertices[corners[2]];
        const Vector3d normal = (b - a).cross(c - a);
        const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
        if (normal.norm() <= 1e-6 * longest * longest) {
            throw NotConvex(NotConvexReason::flat, facePlace(f));
        }
        normals.push_back(normal.normalized());
    }
    for (const ConvexPolyhedron::Edge& edge : body.edges) {
        for (std::size_t side = 0; side < 2; ++side) {
            for (const std::uint32_t corner : body.faces[edge.faces[1 - side]].corners) {
                const Vector3d from = body.vertices[corner] - body.vertices[edge.ends[0]];
                if (normals[edge.faces[side]].dot(from) > 1e-6 * body.size) {
                    throw NotConvex(NotConvexReason::concave, facePlace(edge.faces[side]));
                }
            }
        }
    }
    if (body.vertices.size() + body.faces.size() != body.edges.size() + 2) {
        throw NotConvex(NotConvexReason::severalPieces, "mesh");
    }
}

}  // namespace

std::string_view name(NotConvexReason reason) noexcept {
    switch (reason) {
        case NotConvexReason::open:
            return "open";
        case NotConvexReason::flat:
            return "flat";
        case NotConvexReason::concave:
            return "concave";
        case NotConvexReason::severalPieces:
            return "severalPieces";
    }
    return "unknown";
}

NotConvex::NotConvex(NotConvexReason reason, const std::string& place)
    : std::invalid_argument("notConvex: " + std::string(name(reason)) + " (" + place + ")"), m_reason(reason) {}

std::span<const std::uint32_t> ConvexPolyhedron::cornersOf(const Feature& feature) const {
    switch (feature.kind) {
        case FeatureKind::edge:
            return edges[feature.index].ends;
        case FeatureKind::face:
            return faces[feature.index].corners;
        case FeatureKind::vertex:
            break;
    }
    // A vertex is its own corner; each edge around it knows it by number.
    const auto& ends = edges[edgesAround[edgesBegin[feature.index]]].ends;
    return {ends.data() + (ends[0] == feature.index ? 0 : 1), 1};
}

std::size_t ConvexPolyhedron::count(FeatureKind kind) const {
    switch (kind) {
        case FeatureKind::edge:
            return edges.size();
        case FeatureKind::face:
            return faces.size();
        case FeatureKind::vertex:
            break;
    }
    return vertices.size();
}

ConvexPolyhedron convexPolyhedron(MeshView mesh) {
    requireUsable(mesh);
    const Topology topology = buildTopology(mesh);
    ConvexPolyhedron body;
    addVertices(mesh, topology, body);
    addEdges(topology, body);
    requireConvex(body);
    return body;
}

}  // namespace grapeshot::scf::reference
