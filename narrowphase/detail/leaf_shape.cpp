#include <grapeshot/narrowphase/detail/leaf_shape.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace grapeshot::detail {
namespace {

using Eigen::Vector3f;

/// Triangles at each welded vertex, in compressed rows.
struct Fans {
    Fans(const Tree& tree, const Topology& topology) : begin(tree.vertices.size() + 1, 0) {
        const auto each = [&](auto&& visit) {
            for (std::uint32_t t = 0; t < tree.triangles.size(); ++t) {
                for (const std::uint32_t corner : tree.triangles[t]) {
                    visit(topology.welded[corner], t);
                }
            }
        };
        each([&](std::uint32_t v, std::uint32_t) { ++begin[v + 1]; });
        for (std::size_t v = 0; v + 1 < begin.size(); ++v) {
            begin[v + 1] += begin[v];
        }
        triangles.resize(begin.back());
        std::vector<std::uint32_t> next(begin.begin(), begin.end() - 1);
        each([&](std::uint32_t v, std::uint32_t t) { triangles[next[v]++] = t; });
    }
    std::vector<std::uint32_t> begin, triangles;
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

std::vector<LeafShape> leafShapes(const Tree& tree, const Topology& topology, const std::vector<Vector3f>& normals,
                                  const std::vector<std::uint16_t>& traits) {
    const Fans fans(tree, topology);
    std::vector<LeafShape> shapes(tree.leaves.size());
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        setBox(tree, tree.leaves[i], shapes[i]);
        setCone(tree, topology, normals, fans, tree.leaves[i], shapes[i]);
        shapes[i].plain = std::all_of(std::begin(tree.leaves[i].triangle), std::end(tree.leaves[i].triangle),
                                      [&](std::uint32_t t) { return t == noTriangle || isPlain(traits[t]); });
    }
    return shapes;
}

}  // namespace grapeshot::detail
