#include "contact_ages.hpp"

#include <algorithm>
#include <numeric>

#include <grapeshot/core/error.hpp>

namespace grapeshot::bench {

namespace {

/// Sets of numbers that are united one by one.
class Unions {
  public:
    explicit Unions(std::size_t count) : m_parent(count) { std::iota(m_parent.begin(), m_parent.end(), 0U); }
    std::uint32_t root(std::uint32_t i) {
        while (m_parent[i] != i) {
            i = m_parent[i] = m_parent[m_parent[i]];
        }
        return i;
    }
    void unite(std::uint32_t i, std::uint32_t j) { m_parent[root(i)] = root(j); }

  private:
    std::vector<std::uint32_t> m_parent;
};

std::vector<std::uint32_t> sortedOnce(std::vector<std::uint32_t> values) {
    std::ranges::sort(values);
    values.erase(std::unique(values.begin(), values.end()), values.end());
    return values;
}

std::vector<std::uint32_t> grown(const Topology& topology, std::vector<std::uint32_t> vertices) {
    const std::size_t count = vertices.size();
    for (std::size_t i = 0; i < count; ++i) {
        const auto ring = topology.ringOf(vertices[i]);
        vertices.insert(vertices.end(), ring.begin(), ring.end());
    }
    return sortedOnce(std::move(vertices));
}

bool share(const std::vector<std::uint32_t>& x, const std::vector<std::uint32_t>& y) {
    for (auto i = x.begin(), j = y.begin(); i != x.end() && j != y.end();) {
        if (*i == *j) {
            return true;
        }
        *i < *j ? ++i : ++j;
    }
    return false;
}

}  // namespace

ContactAges::ContactAges(MeshView a, MeshView b, float maxDistance)
    : m_treeA(build(a)),
      m_treeB(build(b)),
      m_topologyA(buildTopology(a)),
      m_topologyB(buildTopology(b)),
      m_maxDistance(maxDistance) {}

int ContactAges::ageOf(const Region& region) const {
    int oldest = 0;
    for (const Region& before : m_before) {
        if (before.age > oldest && share(before.a, region.a) && share(before.b, region.b)) {
            oldest = before.age;
        }
    }
    return oldest + 1;
}

TrueRegions ContactAges::next(std::span<const Eigen::Vector3f> a, std::span<const Eigen::Vector3f> b) {
    refit(m_treeA, a);
    refit(m_treeB, b);
    Query query(m_treeA, m_treeB);
    const Contacts contacts = query.contacts({}, {.maxDistance = m_maxDistance});
    if (!contacts.certain) {
        throw Error(Fault::badSetting, "the exact contacts are not certain", "contact ages");
    }
    const auto verticesB = static_cast<std::uint32_t>(a.size());  // B's vertices count from here
    const auto cornersOf = [&](const TrianglePair& pair) {
        std::array<std::uint32_t, 6> corners{};
        for (std::size_t c = 0; c < 3; ++c) {
            corners[c] = m_topologyA.welded[m_treeA.triangles[pair.triangleA][c]];
            corners[3 + c] = verticesB + m_topologyB.welded[m_treeB.triangles[pair.triangleB][c]];
        }
        return corners;
    };
    Unions unions(a.size() + b.size());
    for (const TriangleContact& contact : contacts.pairs) {
        const auto corners = cornersOf(contact.pair);
        for (const std::uint32_t corner : corners) {
            unions.unite(corners[0], corner);
        }
    }
    TrueRegions result;
    std::map<std::uint32_t, std::size_t> regionOfRoot;
    std::vector<Region> regions;
    for (const TriangleContact& contact : contacts.pairs) {
        const auto corners = cornersOf(contact.pair);
        const auto [entry, fresh] = regionOfRoot.try_emplace(unions.root(corners[0]), regions.size());
        if (fresh) {
            regions.emplace_back();
        }
        result.regionOf.emplace(contact.pair, entry->second);
        Region& region = regions[entry->second];
        region.a.insert(region.a.end(), corners.begin(), corners.begin() + 3);
        for (std::size_t c = 3; c < 6; ++c) {
            region.b.push_back(corners[c] - verticesB);
        }
    }
    for (Region& region : regions) {
        region.a = sortedOnce(std::move(region.a));
        region.b = sortedOnce(std::move(region.b));
        region.age = ageOf(region);
        result.ages.push_back(region.age);
    }
    for (Region& region : regions) {
        region.a = grown(m_topologyA, std::move(region.a));
        region.b = grown(m_topologyB, std::move(region.b));
    }
    m_before = std::move(regions);
    return result;
}

}  // namespace grapeshot::bench
