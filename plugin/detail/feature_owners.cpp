#include <grapeshot/plugin/detail/feature_owners.hpp>

#include <algorithm>
#include <utility>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

FeatureOwners ownersOf(std::span<const Triangle> triangles, std::size_t vertices) {
    FeatureOwners owners(triangles.size(), 0);
    std::vector<bool> taken(vertices, false);
    std::vector<std::pair<std::uint64_t, std::uint32_t>> edges;  // both ends, then 3 * triangle + edge
    edges.reserve(3 * triangles.size());
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
        for (std::uint32_t i = 0; i < 3; ++i) {
            const std::uint32_t from = triangles[t][i];
            const std::uint32_t to = triangles[t][(i + 1) % 3];
            if (!taken[from]) {
                taken[from] = true;
                owners[t] = static_cast<std::uint8_t>(owners[t] | (1U << i));
            }
            const auto [low, high] = std::minmax(from, to);
            edges.emplace_back((std::uint64_t{low} << 32U) | high, 3 * t + i);
        }
    }
    std::ranges::sort(edges);
    for (std::size_t i = 0; i < edges.size(); ++i) {
        if (i == 0 || edges[i].first != edges[i - 1].first) {
            const std::uint32_t t = edges[i].second / 3;
            owners[t] = static_cast<std::uint8_t>(owners[t] | (8U << (edges[i].second % 3)));
        }
    }
    return owners;
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
