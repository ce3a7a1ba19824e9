#include <grapeshot/narrowphase/model_builder.hpp>

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include <grapeshot/adb/tree_builder.hpp>
#include <grapeshot/core/mesh_slices.hpp>
#include <grapeshot/narrowphase/detail/leaf_shape.hpp>
#include <grapeshot/scf/stretch.hpp>

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
// Balls are built anew for vertices that moved so that an edge is longer by more than this factor.
constexpr float mostStretch = 1.5F;

/// An empty vector gets `size` elements bit by bit: memory is touched for the first time.
template <class T>
Sliced fill(std::vector<T>& values, std::size_t size, T value) {
    values.clear();
    values.reserve(size);
    const auto grow = [&](std::size_t, std::size_t end) { values.resize(end, value); };
    co_await inPieces(0, size, std::max<std::size_t>(1, 2048 / sizeof(T)), grow);
}

Sliced computeTriangleNormals(MeshModel& model) {
    const Tree& tree = model.tree;
    co_await fill(model.triangleNormals, tree.triangles.size(), Vector3f(Vector3f::Zero()));
    const auto some = [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t) {
            const Triangle& corner = tree.triangles[t];
            const Vector3d p = tree.vertices[corner[0]].cast<double>();
            const Vector3d u = tree.vertices[corner[1]].cast<double>() - p;
            const Vector3d v = tree.vertices[corner[2]].cast<double>() - p;
            const Vector3d cross = u.cross(v);
            const double longest = std::max({u.squaredNorm(), v.squaredNorm(), (v - u).squaredNorm()});
            const double length = cross.norm();
            if (length > degenerate * longest) {
                model.triangleNormals[t] = (cross / length).cast<float>();
            }
        }
    };
    co_await inPieces(0, tree.triangles.size(), 16, some);
}

Sliced computeVertexNormals(MeshModel& model) {
    const Tree& tree = model.tree;
    const auto& welded = model.topology.welded;
    std::vector<Vector3d> sum;
    co_await fill(sum, tree.vertices.size(), Vector3d(Vector3d::Zero()));
    const auto addUp = [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t) {
            const Triangle& corner = tree.triangles[t];
            for (int c = 0; c < 3; ++c) {
                const Vector3d p = tree.vertices[corner[c]].cast<double>();
                const Vector3d u = tree.vertices[corner[(c + 1) % 3]].cast<double>() - p;
                const Vector3d v = tree.vertices[corner[(c + 2) % 3]].cast<double>() - p;
                const double angle = std::atan2(u.cross(v).norm(), u.dot(v));
                sum[welded[corner[c]]] += angle * model.triangleNormals[t].cast<double>();
            }
        }
    };
    co_await inPieces(0, tree.triangles.size(), 2, addUp);
    co_await fill(model.vertexNormals, tree.vertices.size(), Vector3f(Vector3f::Zero()));
    const auto normalise = [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v) {
            const Vector3d& total = sum[welded[v]];
            const double length = total.norm();
            if (length > 1e-6) {
                model.vertexNormals[v] = (total / length).cast<float>();
            }
        }
    };
    co_await inPieces(0, sum.size(), 32, normalise);
}

Sliced computeVertexCones(MeshModel& model) {
    const auto& welded = model.topology.welded;
    const std::size_t triangles = model.tree.triangles.size();
    // The rim of a sheet can be touched from anywhere.
    std::vector<bool> border(model.vertexNormals.size(), false);
    const auto findBorder = [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t) {
            for (unsigned e = 0; e < 3; ++e) {
                if (model.topology.across[t][e] == noNeighbour) {
                    border[welded[model.tree.triangles[t][e]]] = true;
                    border[welded[model.tree.triangles[t][(e + 1) % 3]]] = true;
                }
            }
        }
    };
    co_await inPieces(0, triangles, 64, findBorder);
    std::vector<float> cosine;
    co_await fill(cosine, model.vertexNormals.size(), 1.0F);
    const auto widen = [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t) {
            const Vector3f& normal = model.triangleNormals[t];
            for (const std::uint32_t corner : model.tree.triangles[t]) {
                const std::uint32_t v = welded[corner];
                const bool known = !normal.isZero() && !model.vertexNormals[v].isZero() && !border[v];
                cosine[v] = known ? std::min(cosine[v], model.vertexNormals[v].dot(normal)) : -1.0F;
            }
        }
    };
    co_await inPieces(0, triangles, 16, widen);
    co_await fill(model.vertexCones, cosine.size(), NormalCone());
    const auto store = [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v) {
            const float bounded = std::max(cosine[v], -1.0F);
            model.vertexCones[v] = {bounded, std::sqrt(std::max(0.0F, 1 - bounded * bounded))};
        }
    };
    co_await inPieces(0, cosine.size(), 64, store);
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

Sliced computeTraits(MeshModel& model) {
    const Tree& tree = model.tree;
    const auto& welded = model.topology.welded;
    auto& firstTriangle = model.vertexTriangle;
    co_await fill(firstTriangle, tree.vertices.size(), noTriangle);
    std::vector<bool> bent(tree.vertices.size(), false);
    const auto findBent = [&](std::size_t begin, std::size_t end) {
        for (auto t = static_cast<std::uint32_t>(begin); t < end; ++t) {
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
    };
    co_await inPieces(0, tree.triangles.size(), 16, findBent);
    model.traits.clear();
    model.traits.reserve(tree.triangles.size());
    const auto collect = [&](std::size_t begin, std::size_t end) {
        for (auto t = static_cast<std::uint32_t>(begin); t < end; ++t) {
            std::uint16_t traits = edgeTraits(model, t);
            for (unsigned c = 0; c < 3; ++c) {
                if (!bent[welded[tree.triangles[t][c]]]) {
                    traits |= flatCorner << c;
                }
            }
            model.traits.push_back(traits);
        }
    };
    co_await inPieces(0, tree.triangles.size(), 6, collect);
}

Sliced computeLeafOf(MeshModel& model) {
    co_await fill(model.leafOf, model.tree.triangles.size(), 0U);
    const auto name = [&](std::size_t begin, std::size_t end) {
        for (auto leaf = static_cast<std::uint32_t>(begin); leaf < end; ++leaf) {
            for (const std::uint32_t triangle : model.tree.leaves[leaf].triangle) {
                if (triangle != noTriangle) {
                    model.leafOf[triangle] = leaf;
                }
            }
        }
    };
    co_await inPieces(0, model.tree.leaves.size(), 16, name);
}

Sliced computeDerived(MeshModel& model) {
    co_await computeTriangleNormals(model);
    co_await computeVertexNormals(model);
    co_await computeVertexCones(model);
    co_await computeTraits(model);
    co_await detail::leafShapesInSlices(model);
    co_await computeLeafOf(model);
    model.solid = model.topology.closed && model.report.volume > 0;
}

Sliced measure(const Tree& tree, MeshReport& report) {
    double volume = 0;
    double area = 0;
    const Vector3d origin = ((tree.lower + tree.upper) / 2).cast<double>();
    const auto add = [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t) {
            const Triangle& corner = tree.triangles[t];
            const Vector3d p = tree.vertices[corner[0]].cast<double>() - origin;
            const Vector3d q = tree.vertices[corner[1]].cast<double>() - origin;
            const Vector3d r = tree.vertices[corner[2]].cast<double>() - origin;
            volume += p.dot(q.cross(r)) / 6;
            area += (q - p).cross(r - p).norm() / 2;
        }
    };
    co_await inPieces(0, tree.triangles.size(), 16, add);
    report.volume = volume;
    report.area = area;
    report.lower = tree.lower;
    report.upper = tree.upper;
}

}  // namespace

Sliced makeModelInSlices(MeshModel& model) {
    co_await buildTopologyInSlices(model.tree.mesh(), model.topology);
    co_await inspectInSlices(model.tree.mesh(), model.report);
    co_await computeDerived(model);
}

namespace {

template <class T>
Sliced copy(const std::vector<T>& from, std::vector<T>& to) {
    to.clear();
    to.reserve(from.size());
    const auto some = [&](std::size_t begin, std::size_t end) {
        to.insert(to.end(), from.begin() + static_cast<std::ptrdiff_t>(begin),
                  from.begin() + static_cast<std::ptrdiff_t>(end));
    };
    co_await inPieces(0, from.size(), std::max<std::size_t>(1, 1024 / sizeof(T)), some);
}

}  // namespace

Sliced copyInSlices(const MeshModel& from, MeshModel& to) {
    to.report = from.report;
    to.features = from.features;
    to.featureStretch = from.featureStretch;
    to.solid = from.solid;
    to.topology.closed = from.topology.closed;
    to.tree.lower = from.tree.lower;
    to.tree.upper = from.tree.upper;
    to.tree.whole = from.tree.whole;
    to.tree.radius = from.tree.radius;
    to.tree.stepRates = from.tree.stepRates;
    co_await copy(from.tree.nodes, to.tree.nodes);
    co_await copy(from.tree.distributions, to.tree.distributions);
    co_await copy(from.tree.leaves, to.tree.leaves);
    co_await copy(from.tree.vertices, to.tree.vertices);
    co_await copy(from.tree.triangles, to.tree.triangles);
    co_await copy(from.topology.welded, to.topology.welded);
    co_await copy(from.topology.across, to.topology.across);
    co_await copy(from.topology.ringBegin, to.topology.ringBegin);
    co_await copy(from.topology.ring, to.topology.ring);
    co_await copy(from.vertexNormals, to.vertexNormals);
    co_await copy(from.vertexCones, to.vertexCones);
    co_await copy(from.triangleNormals, to.triangleNormals);
    co_await copy(from.traits, to.traits);
    co_await copy(from.vertexTriangle, to.vertexTriangle);
    co_await copy(from.leafShapes, to.leafShapes);
    co_await copy(from.leafOf, to.leafOf);
}

Sliced addFeaturesInSlices(MeshModel& model) {
    if (!model.features) {
        auto features = std::make_shared<FeatureModel>();
        co_await makeFeatureModelInSlices(model.tree, model.leafOf, *features);
        model.features = std::move(features);
        model.featureStretch = 0;
    }
}

Sliced refitInSlices(MeshModel& model, std::span<const Eigen::Vector3f> vertices) {
    co_await refitInSlices(model.tree, vertices);  // throws before anything changes
    co_await measure(model.tree, model.report);
    co_await computeDerived(model);
    if (model.features) {
        co_yield mostSlicedPiece;
        model.featureStretch = std::max(1.0F, measureStretch(model.features->balls.surface, vertices));
        if (!(model.featureStretch <= mostStretch)) {
            model.features.reset();
            co_await addFeaturesInSlices(model);
        }
    }
}

MeshModel makeModel(MeshView mesh, const BuildSettings& settings) {
    return makeModelOf(build(mesh, settings));
}

MeshModel makeModelOf(Tree tree) {
    MeshModel model;
    model.tree = std::move(tree);
    makeModelInSlices(model).run();
    return model;
}

MeshModel makeTrackedModel(MeshView mesh, const BuildSettings& settings) {
    MeshModel model = makeModel(mesh, settings);
    addFeatures(model);
    return model;
}

void addFeatures(MeshModel& model) {
    addFeaturesInSlices(model).run();
}

void refit(MeshModel& model, std::span<const Eigen::Vector3f> vertices) {
    refitInSlices(model, vertices).run();
}

}  // namespace grapeshot
