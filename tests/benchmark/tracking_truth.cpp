#include "tracking_truth.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace grapeshot::bench {

namespace {

Eigen::Vector3f middleOf(const TrackedContact& contact) {
    return 0.5F * (contact.onA + contact.onB);
}

std::uint64_t keyOf(std::uint32_t a, std::uint32_t b) {
    return std::uint64_t{a} << 32U | b;
}

/// Of the cube of a grid that a point is in, moved by whole cubes.
std::uint64_t placeOf(const Eigen::Vector3f& point, float size, int x, int y, int z) {
    const auto index = [&](float value, int shift) {
        return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(value / size)) + shift + (1 << 20));
    };
    return index(point[0], x) << 42U | index(point[1], y) << 21U | index(point[2], z);
}

/// Runs over the 27 cubes around a point until `run` says true.
template <class Run>
bool anyAround(const Eigen::Vector3f& point, float size, const Run& run) {
    for (int i = 0; i < 27; ++i) {
        if (run(placeOf(point, size, i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1))) {
            return true;
        }
    }
    return false;
}

std::uint32_t rootOf(std::vector<std::uint32_t>& parent, std::uint32_t i) {
    while (parent[i] != i) {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    return i;
}

}  // namespace

double coverage(std::span<const TrackedContact> truth, std::span<const TrackedContact> reported, float radius) {
    if (truth.empty()) {
        return 1;
    }
    std::unordered_map<std::uint64_t, std::vector<Eigen::Vector3f>> grid;
    for (const TrackedContact& contact : reported) {
        grid[placeOf(middleOf(contact), radius, 0, 0, 0)].push_back(middleOf(contact));
    }
    std::size_t covered = 0;
    for (const TrackedContact& contact : truth) {
        const Eigen::Vector3f middle = middleOf(contact);
        covered += anyAround(middle, radius, [&](std::uint64_t place) {
            const auto found = grid.find(place);
            return found != grid.end() && std::ranges::any_of(found->second, [&](const Eigen::Vector3f& other) {
                       return (other - middle).squaredNorm() <= radius * radius;
                   });
        });
    }
    return static_cast<double>(covered) / static_cast<double>(truth.size());
}

void RegionHistory::advance(std::span<const TrackedContact> truth, const Surface& a, const Surface& b) {
    std::vector<std::uint32_t> parent(truth.size());
    std::iota(parent.begin(), parent.end(), 0U);
    std::unordered_map<std::uint64_t, std::uint32_t> firstAt;
    firstAt.reserve(9 * truth.size());
    for (std::uint32_t i = 0; i < truth.size(); ++i) {
        for (const std::uint32_t v : a.triangles[truth[i].pair.triangleA]) {
            for (const std::uint32_t w : b.triangles[truth[i].pair.triangleB]) {
                const auto [place, isNew] = firstAt.try_emplace(keyOf(v, w), i);
                if (!isNew) {
                    parent[rootOf(parent, i)] = rootOf(parent, place->second);
                }
            }
        }
    }
    std::unordered_map<std::uint32_t, std::uint32_t> regionOfRoot;
    m_regionOfPair.clear();
    m_ages.clear();
    std::vector<std::uint32_t> regionOf(truth.size());
    for (std::uint32_t i = 0; i < truth.size(); ++i) {
        const auto [region, isNew] =
            regionOfRoot.try_emplace(rootOf(parent, i), static_cast<std::uint32_t>(m_ages.size()));
        if (isNew) {
            m_ages.push_back(1);
        }
        regionOf[i] = region->second;
        m_regionOfPair[keyOf(truth[i].pair.triangleA, truth[i].pair.triangleB)] = region->second;
        anyAround(middleOf(truth[i]), m_spacing, [&](std::uint64_t place) {
            const auto before = m_agesBefore.find(place);
            if (before != m_agesBefore.end()) {
                m_ages[region->second] = std::max(m_ages[region->second], before->second + 1);
            }
            return false;
        });
    }
    m_agesBefore.clear();
    for (std::uint32_t i = 0; i < truth.size(); ++i) {
        int& age = m_agesBefore[placeOf(middleOf(truth[i]), m_spacing, 0, 0, 0)];
        age = std::max(age, m_ages[regionOf[i]]);
    }
}

std::vector<bool> RegionHistory::found(std::span<const TrackedContact> reported) const {
    std::vector<bool> result(m_ages.size(), false);
    for (const TrackedContact& contact : reported) {
        const auto region = m_regionOfPair.find(keyOf(contact.pair.triangleA, contact.pair.triangleB));
        if (region != m_regionOfPair.end()) {
            result[region->second] = true;
        }
    }
    return result;
}

}  // namespace grapeshot::bench
