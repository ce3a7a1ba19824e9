// This work is based on:
// J. Andreas Baerentzen, Henrik Aanaes. Signed Distance Computation Using the Angle Weighted Pseudonormal. TVCG 2005
// Christer Ericson. Real-Time Collision Detection. 2005, section 5.1.5 (closest point on a triangle, by regions)
#include "true_penetration.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

namespace grapeshot::scenes {

using Eigen::Vector3d;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

struct Face {
    std::array<std::size_t, 3> corners;
    std::array<Vector3d, 3> edgeNormals;  ///< of the edges 0-1, 1-2, 2-0
    Vector3d normal;
};

struct Box {
    Vector3d lower = Vector3d::Constant(infinity);
    Vector3d upper = Vector3d::Constant(-infinity);
    void add(const Vector3d& p) {
        lower = lower.cwiseMin(p);
        upper = upper.cwiseMax(p);
    }
    [[nodiscard]] double squaredDistance(const Vector3d& p) const {
        return (lower - p).cwiseMax(p - upper).cwiseMax(0.0).squaredNorm();
    }
};

/// Inner: children `first` and `first + 1`. Leaf: faces [first, first + count) of the order.
struct Node {
    Box box;
    std::size_t first = 0;
    std::size_t count = 0;
};

struct Closest {
    double squaredDistance = infinity;
    Vector3d point = Vector3d::Zero();
    Vector3d pseudonormal = Vector3d::Zero();
};

PoseD bInA(const PoseD& poseA, const PoseD& poseB) {
    return {poseA.rotation.transpose() * poseB.rotation,
            poseA.rotation.transpose() * (poseB.translation - poseA.translation)};
}

bool finite(const PoseD& pose) {
    return pose.rotation.allFinite() && pose.translation.allFinite();
}

}  // namespace

struct TrueSurface::State {
    std::vector<Vector3d> vertices;
    std::vector<Vector3d> vertexNormals;
    std::vector<Face> faces;
    std::vector<std::size_t> order;
    std::vector<Node> nodes;
    std::vector<Vector3d> samples;
    Box box;
    bool closed = false;
    double inward = 1;  ///< -1 if the mesh is inside out

    void weld(MeshView mesh);
    void computeNormals();
    void build(std::size_t node, std::size_t first, std::size_t last);
    void closestOnFace(const Face& face, const Vector3d& p, Closest& best) const;
    [[nodiscard]] Closest closest(const Vector3d& p) const;
};

void TrueSurface::State::weld(MeshView mesh) {
    std::map<std::array<float, 3>, std::size_t> known;
    std::vector<std::size_t> index;
    for (const Eigen::Vector3f& v : mesh.vertices) {
        const auto [entry, fresh] = known.try_emplace({v.x(), v.y(), v.z()}, vertices.size());
        if (fresh) {
            vertices.push_back(v.cast<double>());
        }
        index.push_back(entry->second);
    }
    for (const Triangle& t : mesh.triangles) {
        Face face{{index[t[0]], index[t[1]], index[t[2]]}, {}, Vector3d::Zero()};
        const auto& [a, b, c] = face.corners;
        face.normal = (vertices[b] - vertices[a]).cross(vertices[c] - vertices[a]);
        if (face.normal.norm() > 0) {
            face.normal.normalize();
            faces.push_back(face);
        }
    }
}

void TrueSurface::State::computeNormals() {
    using Edge = std::pair<std::size_t, std::size_t>;
    struct Sides {
        Vector3d normal = Vector3d::Zero();
        int forward = 0;
        int backward = 0;
    };
    std::map<Edge, Sides> edges;
    vertexNormals.assign(vertices.size(), Vector3d::Zero());
    double volume = 0;
    for (const Face& face : faces) {
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t from = face.corners[k];
            const std::size_t to = face.corners[(k + 1) % 3];
            const std::size_t other = face.corners[(k + 2) % 3];
            Sides& sides = edges[std::minmax(from, to)];
            sides.normal += face.normal;
            ++(from < to ? sides.forward : sides.backward);
            const Vector3d u = vertices[to] - vertices[from];
            const Vector3d v = vertices[other] - vertices[from];
            vertexNormals[from] += std::atan2(u.cross(v).norm(), u.dot(v)) * face.normal;
        }
        volume += vertices[face.corners[0]].dot(vertices[face.corners[1]].cross(vertices[face.corners[2]]));
    }
    closed = !faces.empty() && std::ranges::all_of(edges, [](const auto& entry) {
        return entry.second.forward == 1 && entry.second.backward == 1;
    });
    inward = volume < 0 ? -1 : 1;
    for (Face& face : faces) {
        for (std::size_t k = 0; k < 3; ++k) {
            face.edgeNormals[k] = edges[std::minmax(face.corners[k], face.corners[(k + 1) % 3])].normal;
        }
        for (const std::size_t corner : face.corners) {
            box.add(vertices[corner]);
        }
    }
    std::vector<bool> used(vertices.size(), false);
    for (const Face& face : faces) {
        for (const std::size_t corner : face.corners) {
            used[corner] = true;
        }
    }
    for (std::size_t v = 0; v < vertices.size(); ++v) {
        if (used[v]) {
            samples.push_back(vertices[v]);
        }
    }
    for (const auto& [edge, sides] : edges) {
        samples.push_back(0.5 * (vertices[edge.first] + vertices[edge.second]));
    }
}

void TrueSurface::State::build(std::size_t node, std::size_t first, std::size_t last) {
    constexpr std::size_t leafSize = 4;
    const auto middle = [&](std::size_t f) -> Vector3d {
        const auto& c = faces[f].corners;
        return (vertices[c[0]] + vertices[c[1]] + vertices[c[2]]) / 3;
    };
    Box bounds;
    Box middles;
    for (std::size_t i = first; i < last; ++i) {
        for (const std::size_t corner : faces[order[i]].corners) {
            bounds.add(vertices[corner]);
        }
        middles.add(middle(order[i]));
    }
    nodes[node].box = bounds;
    if (last - first <= leafSize) {
        nodes[node].first = first;
        nodes[node].count = last - first;
        return;
    }
    int axis = 0;
    (middles.upper - middles.lower).maxCoeff(&axis);
    const std::size_t half = first + (last - first) / 2;
    const auto at = [&](std::size_t i) { return order.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(first), at(half), at(last), [&](std::size_t f, std::size_t g) {
        return std::pair(middle(f)[axis], f) < std::pair(middle(g)[axis], g);
    });
    const std::size_t child = nodes.size();
    nodes.resize(child + 2);
    nodes[node].first = child;
    build(child, first, half);
    build(child + 1, half, last);
}

void TrueSurface::State::closestOnFace(const Face& face, const Vector3d& p, Closest& best) const {
    const Vector3d& a = vertices[face.corners[0]];
    const Vector3d& b = vertices[face.corners[1]];
    const Vector3d& c = vertices[face.corners[2]];
    const Vector3d ab = b - a;
    const Vector3d ac = c - a;
    const auto offer = [&](const Vector3d& point, const Vector3d& pseudonormal) {
        const double squared = (p - point).squaredNorm();
        if (squared < best.squaredDistance) {
            best = {squared, point, pseudonormal};
        }
    };
    const double d1 = ab.dot(p - a);
    const double d2 = ac.dot(p - a);
    if (d1 <= 0 && d2 <= 0) {
        return offer(a, vertexNormals[face.corners[0]]);
    }
    const double d3 = ab.dot(p - b);
    const double d4 = ac.dot(p - b);
    if (d3 >= 0 && d4 <= d3) {
        return offer(b, vertexNormals[face.corners[1]]);
    }
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) {
        return offer(a + d1 / (d1 - d3) * ab, face.edgeNormals[0]);
    }
    const double d5 = ab.dot(p - c);
    const double d6 = ac.dot(p - c);
    if (d6 >= 0 && d5 <= d6) {
        return offer(c, vertexNormals[face.corners[2]]);
    }
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) {
        return offer(a + d2 / (d2 - d6) * ac, face.edgeNormals[2]);
    }
    const double va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
        return offer(b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b), face.edgeNormals[1]);
    }
    const double scale = 1 / (va + vb + vc);
    return offer(a + vb * scale * ab + vc * scale * ac, face.normal);
}

Closest TrueSurface::State::closest(const Vector3d& p) const {
    Closest best;
    if (nodes.empty()) {
        return best;
    }
    std::vector<std::pair<double, std::size_t>> stack{{nodes.front().box.squaredDistance(p), 0}};
    while (!stack.empty()) {
        const auto [bound, index] = stack.back();
        stack.pop_back();
        if (bound >= best.squaredDistance) {
            continue;
        }
        const Node& node = nodes[index];
        if (node.count > 0) {
            for (std::size_t i = node.first; i < node.first + node.count; ++i) {
                closestOnFace(faces[order[i]], p, best);
            }
            continue;
        }
        std::pair<double, std::size_t> near{nodes[node.first].box.squaredDistance(p), node.first};
        std::pair<double, std::size_t> far{nodes[node.first + 1].box.squaredDistance(p), node.first + 1};
        if (far.first < near.first) {
            std::swap(near, far);
        }
        stack.push_back(far);
        stack.push_back(near);
    }
    return best;
}

TrueSurface::TrueSurface(MeshView mesh) : m_state(std::make_unique<State>()) {
    State& state = *m_state;
    state.weld(mesh);
    state.computeNormals();
    state.order.resize(state.faces.size());
    std::iota(state.order.begin(), state.order.end(), std::size_t{0});
    if (!state.faces.empty()) {
        state.nodes.resize(1);
        state.build(0, 0, state.faces.size());
    }
}

TrueSurface::~TrueSurface() = default;
TrueSurface::TrueSurface(TrueSurface&&) noexcept = default;
TrueSurface& TrueSurface::operator=(TrueSurface&&) noexcept = default;

double TrueSurface::signedDistance(const Vector3d& point) const {
    const Closest best = m_state->closest(point);
    const double distance = std::sqrt(best.squaredDistance);
    if (!m_state->closed) {
        return distance;
    }
    const double side = (point - best.point).dot(best.pseudonormal) * m_state->inward;
    return side < 0 ? -distance : distance;
}

const std::vector<Vector3d>& TrueSurface::samples() const {
    return m_state->samples;
}
const Vector3d& TrueSurface::lower() const {
    return m_state->box.lower;
}
const Vector3d& TrueSurface::upper() const {
    return m_state->box.upper;
}
bool TrueSurface::closed() const {
    return m_state->closed;
}

namespace {

double depthOfSamples(const TrueSurface& a, const TrueSurface& b, const PoseD& aInB) {
    if (!b.closed()) {
        return 0;
    }
    double depth = 0;
    for (const Vector3d& sample : a.samples()) {
        const Vector3d p = aInB.rotation * sample + aInB.translation;
        // Inside the box by no more than the depth known already: no candidate.
        const double reach = (p - b.lower()).cwiseMin(b.upper() - p).minCoeff();
        if (reach > depth) {
            depth = std::max(depth, -b.signedDistance(p));
        }
    }
    return depth;
}

/// Could the two boxes meet? By the separating planes of the faces of both.
bool boxesApart(const TrueSurface& a, const TrueSurface& b, const PoseD& aInB) {
    const Vector3d centre = aInB.rotation * (0.5 * (a.lower() + a.upper())) + aInB.translation;
    const Vector3d reach = aInB.rotation.cwiseAbs() * (0.5 * (a.upper() - a.lower()));
    return ((centre - reach).array() > b.upper().array()).any() || ((centre + reach).array() < b.lower().array()).any();
}

}  // namespace

double truePenetration(const TrueSurface& a, const PoseD& poseA, const TrueSurface& b, const PoseD& poseB) {
    if (!finite(poseA) || !finite(poseB) || a.samples().empty() || b.samples().empty()) {
        return 0;
    }
    const PoseD aInB = bInA(poseB, poseA);
    const PoseD bInFrameOfA = bInA(poseA, poseB);
    if (boxesApart(a, b, aInB) || boxesApart(b, a, bInFrameOfA)) {
        return 0;
    }
    return std::max(depthOfSamples(a, b, aInB), depthOfSamples(b, a, bInFrameOfA));
}

double penetrationBelowPlane(const TrueSurface& a, const PoseD& poseA, const Vector3d& normal, double offset) {
    if (!finite(poseA)) {
        return 0;
    }
    const Vector3d inBody = poseA.rotation.transpose() * normal;
    const double shift = normal.dot(poseA.translation) - offset;
    double depth = 0;
    for (const Vector3d& sample : a.samples()) {
        depth = std::max(depth, -(inBody.dot(sample) + shift));
    }
    return depth;
}

double penetrationIntoBox(const TrueSurface& a, const PoseD& poseA, const Vector3d& half, const PoseD& boxPose) {
    if (!finite(poseA) || !finite(boxPose)) {
        return 0;
    }
    const PoseD aInBox = bInA(boxPose, poseA);
    double depth = 0;
    for (const Vector3d& sample : a.samples()) {
        const Vector3d p = aInBox.rotation * sample + aInBox.translation;
        depth = std::max(depth, (half - p.cwiseAbs()).minCoeff());
    }
    return depth;
}

}  // namespace grapeshot::scenes
