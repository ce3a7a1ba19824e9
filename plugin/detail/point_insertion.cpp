#include <grapeshot/plugin/detail/point_insertion.hpp>

#include <algorithm>
#include <array>
#include <cassert>
#include <optional>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

namespace {

constexpr int none = -1;
constexpr int most = MANIFOLD_CACHE_SIZE;

/// For each of the points the kept one that it continues.
using Matches = std::array<int, most>;

Matches match(const btPersistentManifold& manifold, std::span<const BulletPoint> points, btScalar reach) {
    Matches matches;
    matches.fill(none);
    std::array<bool, most> taken{};
    for (std::size_t round = 0; round < points.size(); ++round) {
        btScalar nearest = reach * reach;
        int bestPoint = none;
        int bestKept = none;
        for (std::size_t p = 0; p < points.size(); ++p) {
            for (int k = 0; matches[p] == none && k < manifold.getNumContacts(); ++k) {
                const btManifoldPoint& kept = manifold.getContactPoint(k);
                const btScalar squared = btMin(kept.m_localPointA.distance2(points[p].localA),
                                               kept.m_localPointB.distance2(points[p].localB));
                if (!taken[static_cast<std::size_t>(k)] && squared <= nearest) {
                    nearest = squared;
                    bestPoint = static_cast<int>(p);
                    bestKept = k;
                }
            }
        }
        if (bestPoint == none) {
            break;
        }
        matches[static_cast<std::size_t>(bestPoint)] = bestKept;
        taken[static_cast<std::size_t>(bestKept)] = true;
    }
    return matches;
}

/// The point becomes another one: no impulses, no user data.
void forget(btPersistentManifold& manifold, btManifoldPoint& point) {
    manifold.clearUserCache(point);
    point.m_userPersistentData = nullptr;
    point.m_appliedImpulse = point.m_prevRHS = 0;
    point.m_appliedImpulseLateral1 = point.m_appliedImpulseLateral2 = 0;
    point.m_contactPointFlags = 0;
    point.m_lifeTime = 0;
}

/// Kept points that go on as none of the new ones: given to new points without one (so that the manifold is not empty
/// in between, which Bullet would tell the program as the end of the contact), else removed.
void recycle(btPersistentManifold& manifold, std::span<const BulletPoint> points, Matches& matches) {
    for (int k = manifold.getNumContacts() - 1; k >= 0; --k) {
        if (std::find(matches.begin(), matches.end(), k) != matches.end()) {
            continue;
        }
        std::size_t p = 0;
        while (p < points.size() && matches[p] != none) {
            ++p;
        }
        if (p < points.size()) {
            forget(manifold, manifold.getContactPoint(k));
            matches[p] = k;
        } else {
            const int last = manifold.getNumContacts() - 1;
            manifold.removeContactPoint(k);
            std::replace(matches.begin(), matches.end(), last, k);
        }
    }
}

/// Hides all points but one from the manifold's search for the nearest, for as long as it lives.
class Blinkers {
  public:
    Blinkers(btPersistentManifold& manifold, int visible) : m_manifold(manifold), m_visible(visible) {
        for (int k = 0; k < manifold.getNumContacts(); ++k) {
            m_localA[static_cast<std::size_t>(k)] = manifold.getContactPoint(k).m_localPointA;
            if (k != visible) {
                constexpr auto away = btScalar(1e15);  // its square is still a number
                manifold.getContactPoint(k).m_localPointA.setValue(away, away, away);
            }
        }
        m_count = manifold.getNumContacts();
    }
    ~Blinkers() {
        for (int k = 0; k < m_count; ++k) {
            if (k != m_visible) {
                m_manifold.getContactPoint(k).m_localPointA = m_localA[static_cast<std::size_t>(k)];
            }
        }
    }
    Blinkers(const Blinkers&) = delete;
    Blinkers& operator=(const Blinkers&) = delete;

  private:
    btPersistentManifold& m_manifold;
    int m_visible;
    int m_count = 0;
    std::array<btVector3, most> m_localA;
};

}  // namespace

void addPoint(btPersistentManifold& manifold, const BulletPoint& point, btManifoldResult& result) {
    result.setPersistentManifold(&manifold);
    const bool sameOrder = result.getBody0Internal() == manifold.getBody0();
    const TriangleId& first = sameOrder ? point.triangleA : point.triangleB;
    const TriangleId& second = sameOrder ? point.triangleB : point.triangleA;
    const TriangleFace& firstFace = sameOrder ? point.faceA : point.faceB;
    const TriangleFace& secondFace = sameOrder ? point.faceB : point.faceA;
    // Solids keep what a compound around them may have set.
    if (first.index >= 0) {
        result.setShapeIdentifiersA(first.part, first.index);
    }
    if (second.index >= 0) {
        result.setShapeIdentifiersB(second.part, second.index);
    }
    std::optional<TriangleInPlace> inPlace0;
    std::optional<TriangleInPlace> inPlace1;
    if (firstFace.mesh != nullptr) {
        inPlace0.emplace(firstFace, first, true, result);
    }
    if (secondFace.mesh != nullptr) {
        inPlace1.emplace(secondFace, second, false, result);
    }
    result.addContactPoint(point.normal, point.position, point.depth);
}

void setPoints(btPersistentManifold& manifold, std::span<const BulletPoint> points, btScalar reach,
               btManifoldResult& result, const bool& stopped) {
    assert(points.size() <= static_cast<std::size_t>(most));
    Matches matches = match(manifold, points, reach);
    recycle(manifold, points, matches);
    for (std::size_t p = 0; p < points.size() && !stopped; ++p) {
        const int kept = matches[p];
        const Blinkers blinkers(manifold, kept);
        if (kept == none) {
            addPoint(manifold, points[p], result);
            continue;
        }
        btManifoldPoint& place = manifold.getContactPoint(kept);
        const btVector3 before = place.m_localPointA;
        place.m_localPointA = points[p].localA;
        addPoint(manifold, points[p], result);
        // A point with a friction anchor is left where it was.
        if (!(place.m_positionWorldOnB == points[p].position) && !(place.m_positionWorldOnA == points[p].position)) {
            place.m_localPointA = before;
        }
    }
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
