#include <grapeshot/scf/reference/detail/local_search.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace grapeshot::scf::reference::detail {

std::uint8_t LocalSearch::coarsestLevel() const {
    return static_cast<std::uint8_t>(std::max(m_a.surface().levels.size(), m_b.surface().levels.size()) - 1);
}

std::size_t LocalSearch::levelOfA(int level) const {
    return std::min(static_cast<std::size_t>(level), m_a.surface().levels.size() - 1);
}

std::size_t LocalSearch::levelOfB(int level) const {
    return std::min(static_cast<std::size_t>(level), m_b.surface().levels.size() - 1);
}

float LocalSearch::distance2(const FeaturePair& pair) const {
    return (m_a.at(levelOfA(pair.level), pair.a) - m_b.at(levelOfB(pair.level), pair.b)).squaredNorm();
}

float LocalSearch::radii(const FeaturePair& pair) const {
    return m_a.radius(levelOfA(pair.level), pair.a) + m_b.radius(levelOfB(pair.level), pair.b);
}

float LocalSearch::gap(const FeaturePair& pair) const {
    return std::max(0.0F, std::sqrt(distance2(pair)) - radii(pair));
}

void LocalSearch::descend(FeaturePair& pair, SearchWork& work) const {
    if (m_settings.multires) {
        while (pair.level < coarsestLevel()) {
            const FeaturePair up = parents(pair);
            if (gap(up) <= static_cast<float>(m_settings.coarsenAt) * radii(up)) {
                break;
            }
            pair = up;
        }
    }
    int left = m_settings.mostMoves;
    while (true) {
        while (left > 0 && move(pair, work)) {
            --left;
        }
        if (pair.level == 0 || gap(pair) > static_cast<float>(m_settings.refineAt) * radii(pair)) {
            return;
        }
        pair = closestChildren(pair, work);
    }
}

bool LocalSearch::move(FeaturePair& pair, SearchWork& work) const {
    const bool moved = m_settings.update == Update::full ? moveFully(pair, work) : moveOneByOne(pair, work);
    work.moves += moved ? 1 : 0;
    return moved;
}

bool LocalSearch::moveFully(FeaturePair& pair, SearchWork& work) const {
    const auto ringA = m_a.level(levelOfA(pair.level)).ring[pair.a];
    const auto ringB = m_b.level(levelOfB(pair.level)).ring[pair.b];
    FeaturePair best = pair;
    float closest = distance2(pair);
    for (std::size_t i = 0; i <= ringA.size(); ++i) {
        for (std::size_t j = 0; j <= ringB.size(); ++j) {
            const FeaturePair other{i == 0 ? pair.a : ringA[i - 1], j == 0 ? pair.b : ringB[j - 1], pair.level};
            const float distance = distance2(other);
            if (distance < closest) {
                closest = distance;
                best = other;
            }
        }
    }
    work.distances += (ringA.size() + 1) * (ringB.size() + 1);
    const bool moved = best.a != pair.a || best.b != pair.b;
    pair = best;
    return moved;
}

bool LocalSearch::moveOneByOne(FeaturePair& pair, SearchWork& work) const {
    bool moved = false;
    float closest = distance2(pair);
    ++work.distances;
    const auto improve = [&](std::uint32_t& end, std::span<const std::uint32_t> ring) {
        const std::uint32_t from = end;
        std::uint32_t best = from;
        for (const std::uint32_t neighbour : ring) {
            end = neighbour;
            const float distance = distance2(pair);
            if (distance < closest) {
                closest = distance;
                best = neighbour;
            }
        }
        work.distances += ring.size();
        end = best;
        moved |= best != from;
    };
    improve(pair.a, m_a.level(levelOfA(pair.level)).ring[pair.a]);
    improve(pair.b, m_b.level(levelOfB(pair.level)).ring[pair.b]);
    return moved;
}

FeaturePair LocalSearch::parents(const FeaturePair& pair) const {
    FeaturePair up{pair.a, pair.b, static_cast<std::uint8_t>(pair.level + 1)};
    if (levelOfA(up.level) != levelOfA(pair.level)) {
        up.a = m_a.level(levelOfA(pair.level)).parent[pair.a];
    }
    if (levelOfB(up.level) != levelOfB(pair.level)) {
        up.b = m_b.level(levelOfB(pair.level)).parent[pair.b];
    }
    return up;
}

FeaturePair LocalSearch::closestChildren(const FeaturePair& pair, SearchWork& work) const {
    const auto below = [](const PlacedSurface& placed, std::size_t here, std::size_t finer,
                          const std::uint32_t& feature) {
        return here == finer ? std::span<const std::uint32_t>(&feature, 1) : placed.level(here).children[feature];
    };
    const int finer = pair.level - 1;
    const auto childrenA = below(m_a, levelOfA(pair.level), levelOfA(finer), pair.a);
    const auto childrenB = below(m_b, levelOfB(pair.level), levelOfB(finer), pair.b);
    FeaturePair best;
    float closest = std::numeric_limits<float>::infinity();
    for (const std::uint32_t a : childrenA) {
        for (const std::uint32_t b : childrenB) {
            const FeaturePair child{a, b, static_cast<std::uint8_t>(finer)};
            const float distance = distance2(child);
            if (distance < closest) {
                closest = distance;
                best = child;
            }
        }
    }
    work.distances += childrenA.size() * childrenB.size();
    return best;
}

}  // namespace grapeshot::scf::reference::detail
