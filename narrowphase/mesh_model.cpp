#include <grapeshot/narrowphase/mesh_model.hpp>

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include <grapeshot/narrowphase/detail/leaf_shape.hpp>

namespace grapeshot {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

// Sines of dihedral angles. Above `sharp`, nearly parallel faces may meet at the edge's crossings; below, a surface
// counts as smooth and one contact tells. `flat` is well above the rounding of normals of small triangles.
constexpr float sharp = 0.09F;
constexpr float flat = 2e-4F;
// Height over longest edge below which a triangle has no normal; as inspect() counts degenerate ones.
constexpr double degenerate = 1e-6;

void computeTriangleNormals(MeshModel& model) {
    const Tree& tree = model.tree;
    model.triangleNormals.resize(tree.triangles.size());
    for (std::size_t t = 0; t < tree.triangles.size(); ++t) {
        const Triangle& corner = tree.triangles[t];
        const Vector3d p = tree.vertices[corner[0]].cast<double>();
        const Vector3d u = tree.vertices[corner[1]].cast<double>() - p;
        const Vector3d v = tree.vertices[corner[2]].cast<double>() - p;
        const Vector3d cross = u.cross(v);
        const double longest = std::max({u.squaredNorm(), v.squaredNorm(), (v - u).squaredNorm()});
        const double length = cross.norm();
        model.triangleNormals[t] =
            length > degenerate * longest ? Vector3f((cross / length).cast<float>()) : Vector3f(Vector3f::Zero());
    }
}

void computeVertexNormals(MeshModel& model) {
    const Tree& tree = model.tree;
    const auto& welded = model.topology.welded;
    std::vector<Vector3d> sum(tree.vertices.size(), Vector3d::Zero());
    for (std::size_t t = 0; t < tree.triangles.size(); ++t) {
        const Triangle& corner = tree.triangles[t];
        for (int c = 0; c < 3; ++c) {
            const Vector3d p = tree.vertices[corner[c]].cast<double>();
            const Vector3d u = tree.vertices[corner[(c + 1) % 3]].cast<double>() - p;
            const Vector3d v = tree.vertices[corner[(c + 2) % 3]].cast<double>() - p;
            const double angle = std::atan2(u.cross(v).norm(), u.dot(v));
            sum[welded[corner[c]]] += angle * model.triangleNormals[t].cast<double>();
        }
    }
    model.vertexNormals.resize(tree.vertices.size());
    for (std::size_t v = 0; v < sum.size(); ++v) {
        const Vector3d& total = sum[welded[v]];
        const double length = total.norm();
        model.vertexNormals[v] = length > 1e-6 ? Vector3f((total / length).cast<float>()) : Vector3f(Vector3f::Zero());
    }
}

void computeVertexCones(MeshModel& model) {
    const auto& welded = model.topology.welded;
    // The rim of a sheet can be touched from anywhere.
    std::vector<bool> border(model.vertexNormals.size(), false);
    for (std::size_t t = 0; t < model.tree.triangles.size(); ++t) {
        for (unsigned e = 0; e < 3; ++e) {
            if (model.topology.across[t][e] == noNeighbour) {
                border[welded[model.tree.triangles[t][e]]] = true;
                border[welded[model.tree.triangles[t][(e + 1) % 3]]] = true;
            }
        }
    }
    std::vector<float> cosine(model.vertexNormals.size(), 1.0F);
    for (std::size_t t = 0; t < model.tree.triangles.size(); ++t) {
        const Vector3f& normal = model.triangleNormals[t];
        for (const std::uint32_t corner : model.tree.triangles[t]) {
            const std::uint32_t v = welded[corner];
            const bool known = !normal.isZero() && !model.vertexNormals[v].isZero() && !border[v];
            cosine[v] = known ? std::min(cosine[v], model.vertexNormals[v].dot(normal)) : -1.0F;
        }
    }
    model.vertexCones.resize(cosine.size());
    for (std::size_t v = 0; v < cosine.size(); ++v) {
        const float bounded = std::max(cosine[v], -1.0F);
        model.vertexCones[v] = {bounded, std::sqrt(std::max(0.0F, 1 - bounded * bounded))};
    }
}

std::uint16_t edgeTraits(const MeshModel& model, std::uint32_t t) {
    const Tree& tree = model.tree;
    const Triangle& corner = tree.triangles[t];
    const Vector3f& normal = model.triangleNormals[t];
    std::uint16_t traits = 0;
    for (unsigned e = 0; e < 3; ++e) {
        const std::uint32_t other = model.topology.across[t][e];
        if (other == noNeighbour) {
            traits |= (sharpEdge | ridgeEdge) << e;
            continue;
        }
        // Sine of the turn about the directed edge: positive where the surface is convex.
        const Vector3f along = tree.vertices[corner[(e + 1) % 3]] - tree.vertices[corner[e]];
        const Vector3f& across = model.triangleNormals[other];
        const float sine = normal.cross(across).dot(along.normalized());
        const float cosine = normal.dot(across);
        const bool unknown = normal.isZero() || across.isZero();
        if (unknown || sine > sharp || (cosine < 0 && sine >= 0)) {
            traits |= sharpEdge << e;
        }
        if (unknown || sine > flat || (cosine < 0 && sine >= 0)) {
            traits |= ridgeEdge << e;
        }
        if (sine < -flat) {
            traits |= concaveEdge << e;
        }
    }
    return traits;
}

void computeTraits(MeshModel& model) {
    const Tree& tree = model.tree;
    const auto& welded = model.topology.welded;
    auto& firstTriangle = model.vertexTriangle;
    firstTriangle.assign(tree.vertices.size(), noTriangle);
    std::vector<bool> bent(tree.vertices.size(), false);
    for (std::uint32_t t = 0; t < tree.triangles.size(); ++t) {
        for (unsigned c = 0; c < 3; ++c) {
            const std::uint32_t v = welded[tree.triangles[t][c]];
            if (firstTriangle[v] == noTriangle) {
                firstTriangle[v] = t;
            }
            const Vector3f difference = model.triangleNormals[t] - model.triangleNormals[firstTriangle[v]];
            const bool border =
                model.topology.across[t][c] == noNeighbour || model.topology.across[t][(c + 2) % 3] == noNeighbour;
            if (border || difference.squaredNorm() > flat * flat) {
                bent[v] = true;
            }
        }
    }
    model.traits.resize(tree.triangles.size());
    for (std::uint32_t t = 0; t < tree.triangles.size(); ++t) {
        std::uint16_t traits = edgeTraits(model, t);
        for (unsigned c = 0; c < 3; ++c) {
            if (!bent[welded[tree.triangles[t][c]]]) {
                traits |= flatCorner << c;
            }
        }
        model.traits[t] = traits;
    }
}

void computeLeafOf(MeshModel& model) {
    model.leafOf.assign(model.tree.triangles.size(), 0);
    for (std::uint32_t leaf = 0; leaf < model.tree.leaves.size(); ++leaf) {
        for (const std::uint32_t triangle : model.tree.leaves[leaf].triangle) {
            if (triangle != noTriangle) {
                model.leafOf[triangle] = leaf;
            }
        }
    }
}

void computeDerived(MeshModel& model) {
    computeTriangleNormals(model);
    computeVertexNormals(model);
    computeVertexCones(model);
    computeTraits(model);
    model.leafShapes = detail::leafShapes(model.tree, model.topology, model.triangleNormals, model.traits);
    computeLeafOf(model);
    model.solid = model.topology.closed && model.report.volume > 0;
}

void measure(const Tree& tree, MeshReport& report) {
    double volume = 0;
    double area = 0;
    const Vector3d origin = ((tree.lower + tree.upper) / 2).cast<double>();
    for (const Triangle& corner : tree.triangles) {
        const Vector3d p = tree.vertices[corner[0]].cast<double>() - origin;
        const Vector3d q = tree.vertices[corner[1]].cast<double>() - origin;
        const Vector3d r = tree.vertices[corner[2]].cast<double>() - origin;
        volume += p.dot(q.cross(r)) / 6;
        area += (q - p).cross(r - p).norm() / 2;
    }
    report.volume = volume;
    report.area = area;
    report.lower = tree.lower;
    report.upper = tree.upper;
}

}  // namespace

MeshModel makeModel(MeshView mesh, const BuildSettings& settings) {
    return makeModelOf(build(mesh, settings));
}

MeshModel makeModelOf(Tree tree) {
    MeshModel model;
    model.tree = std::move(tree);
    model.topology = buildTopology(model.tree.mesh());
    model.report = inspect(model.tree.mesh());
    computeDerived(model);
    return model;
}

void refit(MeshModel& model, std::span<const Eigen::Vector3f> vertices) {
    refit(model.tree, vertices);  // throws before anything changes
    measure(model.tree, model.report);
    computeDerived(model);
}

}  // namespace grapeshot
