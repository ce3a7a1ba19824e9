#include <grapeshot/plugin/detail/sampled_mesh.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <grapeshot/core/mesh_report.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

namespace {

using Corners = std::array<Eigen::Vector3f, 3>;

/// False if it is none that a tree could be built on.
bool readCorners(const PartSource& source, int index, Corners& corners) {
    const Triangle triangle = source.triangle(index);
    for (std::size_t i = 0; i < 3; ++i) {
        if (triangle[i] >= static_cast<std::uint32_t>(source.vertices)) {
            return false;
        }
        corners[i] = source.vertex(static_cast<int>(triangle[i]));
        if (!corners[i].allFinite() || corners[i].cwiseAbs().maxCoeff() > largestCoordinate) {
            return false;
        }
    }
    return true;
}

}  // namespace

ShapeMesh sampledMesh(std::span<const PartSource> sources) {
    std::size_t count = 0;
    for (const PartSource& source : sources) {
        count += static_cast<std::size_t>(source.triangles);
    }
    const std::size_t stride = std::max<std::size_t>(1, count / sampledShapeTriangles);
    std::vector<Corners> sampled;
    std::size_t first = 0;
    std::size_t next = 0;  // the stratum
    for (const PartSource& source : sources) {
        const auto size = static_cast<std::size_t>(source.triangles);
        for (; sampled.size() < sampledShapeTriangles; ++next) {
            // Not at the same place in each: the rows of a grid may be as long as the stride.
            const std::size_t index = next * stride + next * 0x9e3779b1U % stride;
            if (index >= first + size) {
                break;
            }
            Corners corners;
            if (index >= first && readCorners(source, static_cast<int>(index - first), corners)) {
                sampled.push_back(corners);
            }
        }
        first += size;
    }
    ShapeMesh mesh;
    if (sampled.empty()) {
        return mesh;
    }
    Eigen::Vector3f lower = Eigen::Vector3f::Constant(std::numeric_limits<float>::infinity());
    Eigen::Vector3f upper = -lower;
    for (const Corners& corners : sampled) {
        for (const Eigen::Vector3f& corner : corners) {
            lower = lower.cwiseMin(corner);
            upper = upper.cwiseMax(corner);
        }
    }
    // Three times as wide as their share: scattered as they are, they would leave a third of the surface open.
    const float widening = 3 * std::sqrt(static_cast<float>(count) / static_cast<float>(sampled.size()));
    for (const Corners& corners : sampled) {
        const Eigen::Vector3f centre = corners[0] / 3 + corners[1] / 3 + corners[2] / 3;
        const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
        for (const Eigen::Vector3f& corner : corners) {
            const Eigen::Vector3f wide = centre + widening * (corner - centre);
            mesh.vertices.emplace_back(wide.cwiseMax(lower).cwiseMin(upper));
        }
        mesh.triangles.push_back({base, base + 1, base + 2});
    }
    return mesh;
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
