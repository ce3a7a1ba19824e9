#include <grapeshot/narrowphase/detail/leaf_shape.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Geometry>

namespace grapeshot::detail {
namespace {

using Eigen::Vector3f;

/// Triangles at each welded vertex, in compressed rows.
struct Fans {
    std::vector<std::uint32_t> begin, triangles;

    Sliced gather(const Tree& tree, const Topology& topology) {
        const std::size_t vertices = tree.vertices.size();
        begin.reserve(vertices + 1);
        const auto clear = [&](std::size_t, std::size_t end) { begin.resize(end, 0); };
        co_await inPieces(0, vertices + 1, 1024, clear);
        const auto count = [&](std::size_t first, std::size_t last) {
            for (std::size_t t = first; t < last; ++t) {
                for (const std::uint32_t corner : tree.triangles[t]) {
                    ++begin[topology.welded[corner] + 1];
                }
            }
        };
        co_await inPieces(0, tree.triangles.size(), 64, count);
        const auto addUp = [&](std::size_t first, std::size_t last) {
            for (std::size_t v = first; v < last; ++v) {
                begin[v + 1] += begin[v];
            }
        };
        co_await inPieces(0, vertices, 256, addUp);
        triangles.reserve(begin.back());
        const auto clearTriangles = [&](std::size_t, std::size_t end) { triangles.resize(end); };
        co_await inPieces(0, begin.back(), 1024, clearTriangles);
        std::vector<std::uint32_t> next;
        next.reserve(vertices);
        const auto copy = [&](std::size_t first, std::size_t last) {
            next.insert(next.end(), begin.begin() + static_cast<std::ptrdiff_t>(first),
                        begin.begin() + static_cast<std::ptrdiff_t>(last));
        };
        co_await inPieces(0, vertices, 1024, copy);
        const auto place = [&](std::size_t first, std::size_t last) {
            for (auto t = static_cast<std::uint32_t>(first); t < last; ++t) {
                for (const std::uint32_t corner : tree.triangles[t]) {
                    triangles[next[topology.welded[corner]]++] = t;
                }
            }
        };
        co_await inPieces(0, tree.triangles.size(), 16, place);
    }
};

// What a triangle in the middle of a flat face has none of, once its flat corners are counted out.
constexpr unsigned flatCorners = flatCorner * 7U;
constexpr unsigned bentEdgesOfAny = (ridgeEdge | concaveEdge | sharpEdge) * 7U;

bool isPlain(std::uint16_t traits) {
    return (traits & flatCorners) == flatCorners && (traits & bentEdgesOfAny) == 0;
}

void setBox(const Tree& tree, const LeafBlock& leaf, LeafShape& shape) {
    Vector3f lower = Vector3f::Constant(std::numeric_limits<float>::infinity());
    Vector3f upper = -lower;
    for (const std::uint32_t t : leaf.triangle) {
        if (t != noTriangle) {
            for (const std::uint32_t corner : tree.triangles[t]) {
                lower = lower.cwiseMin(tree.vertices[corner]);
                upper = upper.cwiseMax(tree.vertices[corner]);
            }
        }
    }
    shape.center = 0.5F * (lower + upper);
    shape.half = 0.5F * (upper - lower);
}

/// How far from a vertex's normal the directions can lie along which no edge leads by more than a lean.
///
/// In the plane across the normal the edges part the directions into wedges, one for each triangle. A direction that is
/// turned from the normal by phi towards some place in a wedge leads along the nearer of its two edges by at least
/// `least` sin(phi) - `drop`.
struct VertexLeans {
    struct Lean {
        float drop = 0;                                        // most of an edge along the normal, by its length
        float least = std::numeric_limits<float>::infinity();  // negative: the wedges do not lie around the normal
    };
    std::vector<Lean> at;  // by welded vertex

    Sliced measure(const MeshModel& model) {
        at.reserve(model.vertexNormals.size());
        const auto clear = [&](std::size_t, std::size_t end) { at.resize(end); };
        co_await inPieces(0, model.vertexNormals.size(), 512, clear);
        const auto add = [&](std::size_t begin, std::size_t end) {
            for (std::size_t t = begin; t < end; ++t) {
                for (unsigned c = 0; c < 3; ++c) {
                    addWedge(model, model.tree.triangles[t], c);
                }
            }
        };
        co_await inPieces(0, model.tree.triangles.size(), 6, add);
    }

    void addWedge(const MeshModel& model, const Triangle& corner, unsigned c) {
        const std::uint32_t v = model.topology.welded[corner[c]];
        const Vector3f& normal = model.vertexNormals[v];
        const Vector3f& here = model.tree.vertices[corner[c]];
        Vector3f along[2] = {model.tree.vertices[corner[(c + 1) % 3]] - here,
                             model.tree.vertices[corner[(c + 2) % 3]] - here};
        Lean& lean = at[v];
        float length[2];
        for (std::size_t i = 0; i < 2; ++i) {
            const float whole = along[i].norm();
            along[i] /= whole > 0 ? whole : 1.0F;
            const float climb = along[i].dot(normal);
            lean.drop = std::max(lean.drop, std::abs(climb));
            along[i] -= climb * normal;
            length[i] = along[i].norm();
        }
        const float longest = length[0] * length[1];
        if (!(normal.dot(along[0].cross(along[1])) > 1e-3F * longest)) {
            lean.least = -1;
            return;
        }
        const float halfAngle = std::sqrt(std::max(0.0F, 0.5F + 0.5F * along[0].dot(along[1]) / longest));  // cosine
        lean.least = std::min(lean.least, std::min(length[0], length[1]) * halfAngle);
    }

    /// Radians.
    [[nodiscard]] float bound(const MeshModel& model, std::uint32_t vertex) const {
        const NormalCone& cone = model.vertexCones[vertex];
        const float always = std::acos(std::clamp(cone.cosine, -1.0F, 1.0F)) + coneWidening(usualLean);
        const auto& [drop, least] = at[vertex];
        const float sine = (cornerLean(model, vertex, usualLean) + drop) / std::max(least, 1e-6F);
        return least > 0 && sine < 1 ? std::min(always, std::asin(sine) + 0.01F) : always;
    }
};

/// Sets axis and spread; what is left as it was stands for every direction.
void setCone(const MeshModel& model, const Fans& fans, const LeafBlock& leaf, LeafShape& shape) {
    Vector3f sum = Vector3f::Zero();
    for (const std::uint32_t t : leaf.triangle) {
        sum += t == noTriangle ? Vector3f(Vector3f::Zero()) : model.triangleNormals[t];
    }
    if (sum.norm() < 0.1F) {
        return;
    }
    shape.axis = sum.normalized();
    float cosine = 1;
    for (const std::uint32_t t : leaf.triangle) {
        for (std::size_t c = 0; t != noTriangle && c < 3; ++c) {
            const std::uint32_t v = model.topology.welded[model.tree.triangles[t][c]];
            for (std::uint32_t i = fans.begin[v]; i < fans.begin[v + 1]; ++i) {
                const Vector3f& normal = model.triangleNormals[fans.triangles[i]];
                const auto& across = model.topology.across[fans.triangles[i]];
                // The rim of a sheet can be touched from anywhere.
                const bool rim = std::find(across.begin(), across.end(), noNeighbour) != across.end();
                cosine = rim || normal.isZero() ? -1 : std::min(cosine, shape.axis.dot(normal));
                if (cosine <= -1) {
                    return;
                }
            }
        }
    }
    const float spread = std::acos(std::clamp(cosine, -1.0F, 1.0F)) + leafSpare;
    if (spread < std::numbers::pi_v<float>) {
        shape.cosSpread = std::cos(spread);
        shape.sinSpread = std::sin(spread);
    }
}

/// After setCone.
void setTouch(const MeshModel& model, const VertexLeans& leans, const LeafBlock& leaf, LeafShape& shape) {
    if (shape.cosSpread <= -1) {
        return;
    }
    const float around = std::acos(shape.cosSpread) - leafSpare;
    float touch = around + edgeSpare;
    for (const std::uint32_t t : leaf.triangle) {
        if (t == noTriangle) {
            continue;
        }
        touch = (model.traits[t] & (sharpEdge * 7U)) != 0 ? std::max(touch, around + sharpEdgeSpare) : touch;
        for (const std::uint32_t corner : model.tree.triangles[t]) {
            const std::uint32_t v = model.topology.welded[corner];
            const Vector3f& normal = model.vertexNormals[v];
            const float off = normal.isZero() ? std::numbers::pi_v<float>
                                              : std::acos(std::clamp(shape.axis.dot(normal), -1.0F, 1.0F));
            touch = std::max(touch, off + leans.bound(model, v));
        }
    }
    touch = std::min(touch, std::numbers::pi_v<float>);
    shape.touch = {std::cos(touch), std::sin(touch)};
}

}  // namespace

Sliced leafShapesInSlices(MeshModel& model) {
    const Tree& tree = model.tree;
    Fans fans;
    co_await fans.gather(tree, model.topology);
    VertexLeans leans;
    co_await leans.measure(model);
    model.leafShapes.clear();
    model.leafShapes.reserve(tree.leaves.size());
    const auto add = [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const LeafBlock& leaf = tree.leaves[i];
            LeafShape& shape = model.leafShapes.emplace_back();
            setBox(tree, leaf, shape);
            setCone(model, fans, leaf, shape);
            setTouch(model, leans, leaf, shape);
            const bool plain = std::all_of(std::begin(leaf.triangle), std::end(leaf.triangle), [&](std::uint32_t t) {
                return t == noTriangle || isPlain(model.traits[t]);
            });
            shape.plain = plain ? 1.0F : 0.0F;
        }
    };
    constexpr std::size_t pieceLeaves = mostSlicedPiece / 4;  // four units each
    for (std::size_t i = 0; i < tree.leaves.size(); i += pieceLeaves) {
        co_yield mostSlicedPiece;
        add(i, std::min(i + pieceLeaves, tree.leaves.size()));
    }
}

}  // namespace grapeshot::detail
