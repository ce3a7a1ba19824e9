#include <grapeshot/scf/reference/detail/pair_removal.hpp>

#include <algorithm>
#include <limits>
#include <set>
#include <tuple>

namespace grapeshot::scf::reference::detail {

namespace {

using Key = std::tuple<std::uint8_t, std::uint32_t, std::uint32_t>;

Key keyOf(const ActivePair& pair) {
    return {pair.level, pair.a, pair.b};
}

bool hasNeighbour(const std::set<Key>& kept, const Surface& a, const Surface& b, const ActivePair& pair) {
    const auto ringOf = [&pair](const Surface& surface, std::uint32_t feature) {
        return surface.levels[std::min<std::size_t>(pair.level, surface.levels.size() - 1)].ring[feature];
    };
    const auto ringA = ringOf(a, pair.a);
    const auto ringB = ringOf(b, pair.b);
    for (std::size_t i = 0; i <= ringA.size(); ++i) {
        for (std::size_t j = 0; j <= ringB.size(); ++j) {
            const Key key{pair.level, i == 0 ? pair.a : ringA[i - 1], j == 0 ? pair.b : ringB[j - 1]};
            if (kept.contains(key)) {
                return true;
            }
        }
    }
    return false;
}

}  // namespace

std::size_t removeRedundant(const Surface& a, const Surface& b, Redundancy redundancy, std::vector<ActivePair>& pairs) {
    const std::size_t before = pairs.size();
    if (redundancy == Redundancy::none) {
        return 0;
    }
    std::ranges::sort(pairs, [](const ActivePair& x, const ActivePair& y) {
        return std::tuple(keyOf(x), y.age) < std::tuple(keyOf(y), x.age);
    });
    const auto [first, last] = std::ranges::unique(pairs, {}, keyOf);
    pairs.erase(first, last);
    if (redundancy == Redundancy::neighbours) {
        std::ranges::stable_sort(pairs, {}, &ActivePair::distance);
        std::set<Key> kept;
        std::erase_if(pairs, [&](const ActivePair& pair) {
            return hasNeighbour(kept, a, b, pair) || !kept.insert(keyOf(pair)).second;
        });
    }
    return before - pairs.size();
}

std::size_t removeFar(float size, const Settings& settings, std::vector<ActivePair>& pairs) {
    const std::size_t before = pairs.size();
    if (settings.removeFar) {
        // A coarse pair's distance is that of its balls, a lower bound: it says how near only if there is no other.
        float closest = std::numeric_limits<float>::infinity();
        float closestCoarse = closest;
        for (const ActivePair& pair : pairs) {
            float& least = pair.level == 0 ? closest : closestCoarse;
            least = std::min(least, pair.distance);
        }
        closest = closest < std::numeric_limits<float>::infinity() ? closest : closestCoarse;
        const auto farthest = static_cast<float>(settings.removeFactor * closest + settings.removeOffset * size);
        std::erase_if(pairs, [&](const ActivePair& pair) { return pair.distance > farthest; });
    }
    if (pairs.size() > static_cast<std::size_t>(settings.mostPairs)) {
        std::ranges::stable_sort(pairs, {}, &ActivePair::distance);
        pairs.resize(static_cast<std::size_t>(settings.mostPairs));
    }
    return before - pairs.size();
}

}  // namespace grapeshot::scf::reference::detail
