#include <grapeshot/scf/reference/detail/pair_creation.hpp>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace grapeshot::scf::reference::detail {

namespace {

using Eigen::Vector3f;

/// Draws of one pair: `drawsPerPair` numbers, each with its own meaning.
constexpr std::uint32_t drawsPerPair = 256;
enum Draw : std::uint32_t { regionDraw = 0, endADraw = 1, endBDraw = 2, triesDraw = 16 };

std::uint32_t indexBelow(std::size_t count, double unit) {
    return static_cast<std::uint32_t>(std::min(unit * static_cast<double>(count), static_cast<double>(count) - 1));
}

Vector3f meanVelocity(std::span<const Vector3f> now, std::span<const Vector3f> before) {
    Vector3f sum = Vector3f::Zero();
    for (std::size_t v = 0; v < now.size(); ++v) {
        sum += now[v] - before[v];
    }
    return sum / static_cast<float>(now.size());
}

/// Running sums of how fast each feature of a level closes in on a body that moves by `other` per step.
std::vector<double> closingSpeeds(const PlacedSurface& placed, std::size_t l, std::span<const Vector3f> before,
                                  const Vector3f& other) {
    const Surface& surface = placed.surface();
    std::vector<double> sums;
    double sum = 0;
    for (const std::uint32_t vertex : placed.level(l).centre) {
        Vector3f normal = Vector3f::Zero();
        for (const std::uint32_t t : surface.fan[surface.featureOf[vertex]]) {
            const auto corners = placed.corners(t);
            normal += (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        }
        const Vector3f velocity = placed.vertices()[vertex] - before[vertex] - other;
        sum += std::max(0.0F, normal.normalized().dot(velocity));
        sums.push_back(sum);
    }
    return sums;
}

/// With the probability of its part of the sum; uniform if the sum is 0.
std::uint32_t drawFrom(const std::vector<double>& sums, double unit) {
    if (!(sums.back() > 0)) {
        return indexBelow(sums.size(), unit);
    }
    const auto found = std::ranges::upper_bound(sums, unit * sums.back());
    return static_cast<std::uint32_t>(std::min<std::ptrdiff_t>(found - sums.begin(), std::ssize(sums) - 1));
}

/// A corner of a random triangle below the node, if possible within `within`.
std::uint32_t drawBelow(const PlacedSurface& placed, std::uint32_t node, const Bounds& within, int tries,
                        const RandomKey& key, std::uint32_t firstDraw) {
    const Surface& surface = placed.surface();
    const auto triangles = trianglesBelow(surface.tree, node);
    std::uint32_t vertex = 0;
    for (int i = 0; i < tries; ++i) {
        const double unit = 3 * randomUnit(key, firstDraw + static_cast<std::uint32_t>(i));
        const std::uint32_t corner = indexBelow(3, unit / 3);
        vertex = surface.triangles[triangles[indexBelow(triangles.size(), unit - corner)]][corner];
        if (within.contains(placed.vertices()[vertex])) {
            break;
        }
    }
    return surface.featureOf[vertex];
}

Bounds sharedBox(const Bounds& a, const Bounds& b, float reach) {
    return {a.lower.cwiseMax(b.lower).array() - reach, a.upper.cwiseMin(b.upper).array() + reach};
}

}  // namespace

Created createPairs(const PlacedSurface& a, const PlacedSurface& b, const Before& before, const Settings& settings,
                    const RandomKey& key) {
    const LocalSearch search(a, b, settings);
    const std::uint8_t level = settings.multires ? search.coarsestLevel() : 0;
    const std::size_t levelA = std::min<std::size_t>(level, a.surface().levels.size() - 1);
    const std::size_t levelB = std::min<std::size_t>(level, b.surface().levels.size() - 1);
    const auto share = [&settings](double part) {
        return static_cast<std::uint32_t>(std::lround(part * settings.newPairs));
    };
    const auto count = static_cast<std::uint32_t>(settings.newPairs);
    const std::uint32_t byHierarchy = share(settings.hierarchyShare);
    std::uint32_t bySpeed = std::min(count - byHierarchy, share(settings.velocityShare));

    Created created;
    std::vector<NodePair> regions;
    if (byHierarchy > 0) {
        regions = overlappingNodes(a.surface().tree, a.boxes(), b.surface().tree, b.boxes(), settings.hierarchyDepth,
                                   settings.maxDistance, created.boxTests);
        created.regions = regions.size();
    }
    std::vector<double> speedsA;
    std::vector<double> speedsB;
    if (before.a.empty()) {
        bySpeed = 0;
    }
    if (bySpeed > 0) {
        speedsA = closingSpeeds(a, levelA, before.a, meanVelocity(b.vertices(), before.b));
        speedsB = closingSpeeds(b, levelB, before.b, meanVelocity(a.vertices(), before.a));
    }
    for (std::uint32_t i = 0; i < count; ++i) {
        const std::uint32_t draw = i * drawsPerPair;
        const auto unit = [&](Draw which) { return static_cast<double>(randomUnit(key, draw + which)); };
        if (i < byHierarchy && !regions.empty()) {
            // Stratified: each region has its turn before one has two.
            const std::uint32_t region = indexBelow(regions.size(), (i + unit(regionDraw)) / byHierarchy);
            const auto [nodeA, nodeB] = regions[region];
            const Bounds within = sharedBox(a.boxes()[nodeA], b.boxes()[nodeB], settings.maxDistance);
            created.pairs.push_back(
                {drawBelow(a, nodeA, within, settings.tries, key, draw + triesDraw),
                 drawBelow(b, nodeB, within, settings.tries, key, draw + triesDraw + drawsPerPair / 4), 0});
        } else if (i >= byHierarchy && i < byHierarchy + bySpeed) {
            created.pairs.push_back({drawFrom(speedsA, unit(endADraw)), drawFrom(speedsB, unit(endBDraw)), level});
        } else {
            created.pairs.push_back({indexBelow(a.level(levelA).centre.size(), unit(endADraw)),
                                     indexBelow(b.level(levelB).centre.size(), unit(endBDraw)), level});
        }
    }
    return created;
}

}  // namespace grapeshot::scf::reference::detail
