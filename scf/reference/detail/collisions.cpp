#include <grapeshot/scf/reference/detail/collisions.hpp>

#include <algorithm>
#include <deque>
#include <set>
#include <tuple>
#include <utility>

#include <grapeshot/scf/reference/detail/fan_distance.hpp>

namespace grapeshot::scf::reference::detail {

namespace {

class CollisionSearch {
  public:
    CollisionSearch(const PlacedSurface& a, const PlacedSurface& b, const Settings& settings, Work& work)
        : m_a(a), m_b(b), m_settings(settings), m_work(work) {}

    [[nodiscard]] bool collides(std::uint32_t a, std::uint32_t b, float distance) const {
        if (m_settings.collisionTest == CollisionTest::triangles) {
            return distance <= m_settings.maxDistance;
        }
        const float radii = 0.5F * (m_a.radius(0, a) + m_b.radius(0, b));
        return (m_a.at(0, a) - m_b.at(0, b)).norm() <= radii + m_settings.maxDistance;
    }

    /// Breadth first: a hit's neighbours at one end or the other, as long as they hit.
    void spreadFrom(std::deque<std::pair<std::uint32_t, std::uint32_t>> open, std::vector<Contact>& contacts) {
        std::set<std::pair<std::uint32_t, std::uint32_t>> seen(open.begin(), open.end());
        const auto visit = [&](std::uint32_t a, std::uint32_t b) {
            if (m_work.spread >= static_cast<std::size_t>(m_settings.mostSpread) || !seen.emplace(a, b).second) {
                return;
            }
            ++m_work.spread;
            const FanDistance fan = fanDistance(m_a, a, m_b, b, m_work.trianglePairs);
            if (collides(a, b, fan.distance)) {
                contacts.push_back({fan.triangleA, fan.triangleB, fan.distance, true});
                open.emplace_back(a, b);
            }
        };
        while (!open.empty()) {
            const auto [a, b] = open.front();
            open.pop_front();
            for (const std::uint32_t neighbour : m_a.level(0).ring[a]) {
                visit(neighbour, b);
            }
            for (const std::uint32_t neighbour : m_b.level(0).ring[b]) {
                visit(a, neighbour);
            }
        }
    }

  private:
    const PlacedSurface& m_a;
    const PlacedSurface& m_b;
    const Settings& m_settings;
    Work& m_work;
};

}  // namespace

std::vector<Contact> collisions(const PlacedSurface& a, const PlacedSurface& b, const Settings& settings,
                                const std::vector<ActivePair>& pairs, Work& work) {
    CollisionSearch search(a, b, settings, work);
    std::vector<Contact> contacts;
    std::deque<std::pair<std::uint32_t, std::uint32_t>> hits;
    for (const ActivePair& pair : pairs) {
        if (pair.level == 0 && search.collides(pair.a, pair.b, pair.distance)) {
            contacts.push_back({pair.triangleA, pair.triangleB, pair.distance, false});
            hits.emplace_back(pair.a, pair.b);
        }
    }
    if (settings.spread) {
        search.spreadFrom(std::move(hits), contacts);
    }
    const auto byTriangles = [](const Contact& c) { return std::pair(c.triangleA, c.triangleB); };
    std::ranges::stable_sort(contacts, {}, byTriangles);
    const auto [first, last] = std::ranges::unique(contacts, {}, byTriangles);
    contacts.erase(first, last);
    return contacts;
}

}  // namespace grapeshot::scf::reference::detail
