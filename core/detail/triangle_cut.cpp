#include <grapeshot/core/detail/triangle_cut.hpp>

#include <Eigen/Geometry>

namespace grapeshot::detail {
namespace {

struct Span {
    Eigen::Vector3d from, to;
};

/// Where the triangle's boundary crosses the plane with the given signed distances of its corners (at least one
/// negative, one not).
Span crossPlane(const TriangleD& corners, const std::array<double, 3>& distance) {
    Span span{};
    bool first = true;
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t j = (i + 1) % 3;
        if ((distance[i] < 0) == (distance[j] < 0)) {
            continue;
        }
        // From the lower to the upper corner, so that both triangles of an edge find the same point.
        const std::size_t low = distance[i] < 0 ? i : j;
        const std::size_t high = distance[i] < 0 ? j : i;
        const double t = distance[low] / (distance[low] - distance[high]);
        (first ? span.from : span.to) = corners[low] + t * (corners[high] - corners[low]);
        first = false;
    }
    return span;
}

}  // namespace

std::optional<TriangleCut> cut(const TriangleD& a, const TriangleD& b) {
    const Eigen::Vector3d normalA = (a[1] - a[0]).cross(a[2] - a[0]);
    const Eigen::Vector3d normalB = (b[1] - b[0]).cross(b[2] - b[0]);
    TriangleCut result{};
    std::array<double, 3> distanceA{}, distanceB{};
    for (std::size_t i = 0; i < 3; ++i) {
        distanceA[i] = normalB.dot(a[i] - b[0]);
        distanceB[i] = normalA.dot(b[i] - a[0]);
        result.insideA |= distanceA[i] < 0 ? 1U << i : 0U;
        result.insideB |= distanceB[i] < 0 ? 1U << i : 0U;
    }
    const Eigen::Vector3d line = normalA.cross(normalB);
    if (result.insideA == 0 || result.insideA == 7 || result.insideB == 0 || result.insideB == 7 ||
        !(line.squaredNorm() > 0)) {
        return std::nullopt;
    }
    Span spanA = crossPlane(a, distanceA);
    Span spanB = crossPlane(b, distanceB);
    for (Span* span : {&spanA, &spanB}) {
        if (line.dot(span->to - span->from) < 0) {
            std::swap(span->from, span->to);
        }
    }
    result.from = line.dot(spanB.from - spanA.from) > 0 ? spanB.from : spanA.from;
    result.to = line.dot(spanB.to - spanA.to) < 0 ? spanB.to : spanA.to;
    if (!(line.dot(result.to - result.from) > 0)) {
        return std::nullopt;
    }
    return result;
}

}  // namespace grapeshot::detail
