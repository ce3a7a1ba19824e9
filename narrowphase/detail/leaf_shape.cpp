#include <grapeshot/narrowphase/detail/leaf_shape.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

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

void setCone(const Tree& tree, const Topology& topology, const std::vector<Vector3f>& normals, const Fans& fans,
             const LeafBlock& leaf, LeafShape& shape) {
    Vector3f sum = Vector3f::Zero();
    for (const std::uint32_t t : leaf.triangle) {
        sum += t == noTriangle ? Vector3f(Vector3f::Zero()) : normals[t];
    }
    if (sum.norm() < 0.1F) {
        return;  // every direction
    }
    shape.axis = sum.normalized();
    float cosine = 1;
    for (const std::uint32_t t : leaf.triangle) {
        for (std::size_t c = 0; t != noTriangle && c < 3; ++c) {
            const std::uint32_t v = topology.welded[tree.triangles[t][c]];
            for (std::uint32_t i = fans.begin[v]; i < fans.begin[v + 1]; ++i) {
                const Vector3f& normal = normals[fans.triangles[i]];
                const auto& across = topology.across[fans.triangles[i]];
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

}  // namespace

Sliced leafShapesInSlices(const Tree& tree, const Topology& topology, const std::vector<Vector3f>& normals,
                          const std::vector<std::uint16_t>& traits, std::vector<LeafShape>& shapes) {
    Fans fans;
    co_await fans.gather(tree, topology);
    shapes.clear();
    shapes.reserve(tree.leaves.size());
    const auto add = [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            LeafShape& shape = shapes.emplace_back();
            setBox(tree, tree.leaves[i], shape);
            setCone(tree, topology, normals, fans, tree.leaves[i], shape);
            shape.plain = std::all_of(std::begin(tree.leaves[i].triangle), std::end(tree.leaves[i].triangle),
                                      [&](std::uint32_t t) { return t == noTriangle || isPlain(traits[t]); });
        }
    };
    constexpr std::size_t pieceLeaves = mostSlicedPiece / 2;  // two units each
    for (std::size_t i = 0; i < tree.leaves.size(); i += pieceLeaves) {
        co_yield mostSlicedPiece;
        add(i, std::min(i + pieceLeaves, tree.leaves.size()));
    }
}

}  // namespace grapeshot::detail
