#include <grapeshot/plugin/detail/manifold_writer.hpp>

#include <algorithm>

#include <grapeshot/adb/tree.hpp>
#include <grapeshot/plugin/detail/convert.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

namespace {

static_assert(maxPointsPerRegion <= MANIFOLD_CACHE_SIZE);

TriangleFace faceOf(const btCollisionObjectWrapper& mesh, const Tree* tree, const TriangleId& id,
                    std::uint32_t triangle) {
    TriangleFace face;
    if (tree != nullptr && id.index >= 0) {
        face.mesh = &mesh;
        for (std::size_t i = 0; i < 3; ++i) {
            face.corner[i] = toBullet(tree->vertices[tree->triangles[triangle][i]]);
        }
    }
    return face;
}

/// In the order of the manifold's bodies.
BulletPoint toBulletPoint(const PersistentPoint& point, const ContactBodies& bodies, bool aIsBody0) {
    const btVector3 normal = (bodies.b->getWorldTransform().getBasis() * toBullet(point.normalInB)).normalized();
    // On the surface that the margin makes of B.
    const btVector3 onB = bodies.b->getWorldTransform() * toBullet(point.localB) + normal * bodies.marginB;
    BulletPoint result;
    result.depth = btScalar(point.signedDistance) - bodies.marginA - bodies.marginB;
    const btVector3 onA = onB + normal * result.depth;
    const auto nameOf = [](std::span<const MeshPart> parts, std::uint32_t triangle) {
        return parts.empty() || triangle == noTriangle ? TriangleId{} : idOf(parts, triangle);
    };
    const TriangleId idA = nameOf(bodies.partsA, point.triangleA);
    const TriangleId idB = nameOf(bodies.partsB, point.triangleB);
    const btVector3 localA = bodies.a->getCollisionObject()->getWorldTransform().invXform(onA);
    const btVector3 localB = bodies.b->getCollisionObject()->getWorldTransform().invXform(onB);
    result.position = aIsBody0 ? onB : onA;
    result.normal = aIsBody0 ? normal : -normal;
    result.localA = aIsBody0 ? localA : localB;
    result.localB = aIsBody0 ? localB : localA;
    result.triangleA = aIsBody0 ? idA : idB;
    result.triangleB = aIsBody0 ? idB : idA;
    const TriangleFace faceA = faceOf(*bodies.a, bodies.treeA, idA, point.triangleA);
    const TriangleFace faceB = faceOf(*bodies.b, bodies.treeB, idB, point.triangleB);
    result.faceA = aIsBody0 ? faceA : faceB;
    result.faceB = aIsBody0 ? faceB : faceA;
    return result;
}

bool isUsable(const BulletPoint& point) {
    return isFinite(point.position) && isFinite(point.normal) && isFinite(btVector3(point.depth, 0, 0)) &&
           isFinite(point.localA) && isFinite(point.localB);
}

}  // namespace

Written ManifoldWriter::write(const ContactSet& now, const ContactSet& ahead, const ContactBodies& bodies, float reach,
                              btManifoldResult& result) {
    Written written;
    for (Own& own : m_own) {
        own.used = false;
    }
    writeSet(now, false, bodies, reach, result, written);
    writeSet(ahead, true, bodies, reach, result, written);
    if (m_stopped) {
        return written;
    }
    for (const Own& own : m_own) {
        if (!own.used) {
            if (result.getPersistentManifold() == own.manifold) {
                result.setPersistentManifold(nullptr);
            }
            m_dispatcher.releaseManifold(own.manifold);
        }
    }
    std::erase_if(m_own, [](const Own& own) { return !own.used; });
    return written;
}

void ManifoldWriter::writeSet(const ContactSet& set, bool ahead, const ContactBodies& bodies, float reach,
                              btManifoldResult& result, Written& written) {
    for (const RegionSlot& slot : set.slots) {
        if (m_stopped) {
            return;  // a body was removed in a callback
        }
        if (slot.id == 0 || slot.count == 0) {
            continue;
        }
        Own* mine = m_shared != nullptr ? nullptr : own(slot.id, ahead, bodies);
        btPersistentManifold* manifold = mine != nullptr ? mine->manifold : m_shared;
        if (manifold == nullptr) {
            continue;  // Bullet's pool is full and must not grow
        }
        const bool aIsBody0 = manifold->getBody0() == bodies.a->getCollisionObject();
        std::array<BulletPoint, maxPointsPerRegion> points;
        std::size_t count = 0;
        for (int i = 0; i < slot.count; ++i) {
            points[count] = toBulletPoint(slot.points[static_cast<std::size_t>(i)], bodies, aIsBody0);
            if (isUsable(points[count])) {
                written.deepest = std::max(written.deepest, static_cast<float>(-points[count].depth));
                ++count;
            }
        }
        const std::span<const BulletPoint> usable(points.data(), count);
        if (mine != nullptr) {
            // A point beyond the threshold would be dropped by Bullet, now or at the next refresh; it takes the
            // distance of two points in the world, which is rounded.
            constexpr auto rounding = btScalar(1.001);
            btScalar threshold = mine->breaking;
            for (const BulletPoint& point : usable) {
                threshold = btMax(threshold, rounding * point.depth);
            }
            manifold->setContactBreakingThreshold(threshold);
            setPoints(*manifold, usable, btScalar(reach), result, m_stopped);
            if (m_stopped) {
                return;  // perhaps before the result had a manifold
            }
            result.refreshContactPoints();  // counts life times, calls the program's gContactProcessedCallback
            mine->used = true;
        } else {
            for (std::size_t i = 0; i < usable.size() && !m_stopped; ++i) {
                addPoint(*manifold, usable[i], result);
            }
        }
        written.contacts += static_cast<int>(count);
        written.ahead += ahead ? static_cast<int>(count) : 0;
        written.manifolds += 1;
    }
}

ManifoldWriter::Own* ManifoldWriter::own(std::uint32_t slot, bool ahead, const ContactBodies& bodies) {
    for (Own& candidate : m_own) {
        if (candidate.slot == slot && candidate.ahead == ahead) {
            return &candidate;
        }
    }
    const btCollisionObjectWrapper* first = bodies.aIsFirst ? bodies.a : bodies.b;
    const btCollisionObjectWrapper* second = bodies.aIsFirst ? bodies.b : bodies.a;
    m_own.reserve(m_own.size() + 1);  // before there is something to lose
    btPersistentManifold* manifold =
        m_dispatcher.getNewManifold(first->getCollisionObject(), second->getCollisionObject());
    if (manifold == nullptr) {
        return nullptr;
    }
    m_own.push_back({manifold, slot, ahead, false, manifold->getContactBreakingThreshold()});
    return &m_own.back();
}

void ManifoldWriter::clear() {
    for (const Own& own : m_own) {
        m_dispatcher.releaseManifold(own.manifold);
    }
    m_own.clear();
}

void ManifoldWriter::collect(btManifoldArray& manifolds) const {
    for (const Own& own : m_own) {
        manifolds.push_back(own.manifold);
    }
}

std::vector<ManifoldState> ManifoldWriter::saved() const {
    std::vector<ManifoldState> states;
    for (const Own& own : m_own) {
        ManifoldState& state = states.emplace_back();
        state.place = own.manifold->m_index1a;
        state.slot = own.slot;
        state.ahead = own.ahead;
        state.breaking = own.breaking;
        copyPoints(*own.manifold, state);
    }
    return states;
}

void ManifoldWriter::adopt(std::size_t index, const ManifoldState& state, const btCollisionObject& body0,
                           const btCollisionObject& body1) {
    m_own.resize(std::max(m_own.size(), index + 1));
    btPersistentManifold* manifold = m_dispatcher.getNewManifold(&body0, &body1);
    if (manifold != nullptr) {
        setPoints(state, *manifold);
        m_own[index] = {manifold, state.slot, state.ahead, false, state.breaking};
    }
}

void ManifoldWriter::adopted() {
    std::erase_if(m_own, [](const Own& own) { return own.manifold == nullptr; });
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
