#include <grapeshot/plugin/detail/manifold_state.hpp>

#include <string>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

namespace {

/// All members of a point but the program's pointer, in one order for both ways.
template <class Point, class Visit>
void forEachMember(Point& point, Visit&& visit) {
    visit(point.m_localPointA);
    visit(point.m_localPointB);
    visit(point.m_positionWorldOnB);
    visit(point.m_positionWorldOnA);
    visit(point.m_normalWorldOnB);
    visit(point.m_distance1);
    visit(point.m_combinedFriction);
    visit(point.m_combinedRollingFriction);
    visit(point.m_combinedSpinningFriction);
    visit(point.m_combinedRestitution);
    visit(point.m_partId0);
    visit(point.m_partId1);
    visit(point.m_index0);
    visit(point.m_index1);
    visit(point.m_contactPointFlags);
    visit(point.m_appliedImpulse);
    visit(point.m_prevRHS);
    visit(point.m_appliedImpulseLateral1);
    visit(point.m_appliedImpulseLateral2);
    visit(point.m_contactMotion1);
    visit(point.m_contactMotion2);
    visit(point.m_contactCFM);
    visit(point.m_contactERP);
    visit(point.m_frictionCFM);
    visit(point.m_lifeTime);
    visit(point.m_lateralFrictionDir1);
    visit(point.m_lateralFrictionDir2);
}

struct Saver {
    ByteWriter& out;
    void operator()(const btVector3& v) const { put(out, v); }
    void operator()(btScalar x) const { out.put(x); }
    void operator()(int x) const { out.put(x); }
};

struct Loader {
    ByteReader& in;
    void operator()(btVector3& v) const { v = getVector(in); }
    void operator()(btScalar& x) const { x = in.get<btScalar>(); }
    void operator()(int& x) const { x = in.get<int>(); }
};

}  // namespace

void copyPoints(const btPersistentManifold& manifold, ManifoldState& state) {
    state.threshold = manifold.getContactBreakingThreshold();
    state.count = manifold.getNumContacts();
    for (int i = 0; i < state.count; ++i) {
        btManifoldPoint& point = state.points[static_cast<std::size_t>(i)];
        point = manifold.getContactPoint(i);
        point.m_userPersistentData = nullptr;
    }
}

void setPoints(const ManifoldState& state, btPersistentManifold& manifold) {
    manifold.setContactBreakingThreshold(state.threshold);
    for (int i = 0; i < state.count; ++i) {
        manifold.addManifoldPoint(state.points[static_cast<std::size_t>(i)], true);
    }
}

void save(const ManifoldState& state, ByteWriter& out) {
    out.put(state.place);
    out.put(state.slot);
    out.put(static_cast<std::uint8_t>(state.ahead));
    out.put(state.breaking);
    out.put(state.threshold);
    out.put(state.count);
    for (int i = 0; i < state.count; ++i) {
        forEachMember(state.points[static_cast<std::size_t>(i)], Saver{out});
    }
}

ManifoldState loadManifoldState(ByteReader& in) {
    ManifoldState state;
    state.place = in.get<int>();
    state.slot = in.get<std::uint32_t>();
    state.ahead = in.flag();
    state.breaking = in.get<btScalar>();
    state.threshold = in.get<btScalar>();
    state.count = in.get<int>();
    in.require(state.count >= 0 && state.count <= MANIFOLD_CACHE_SIZE, std::to_string(state.count) + " points");
    for (int i = 0; i < state.count; ++i) {
        btManifoldPoint& point = state.points[static_cast<std::size_t>(i)];
        point = btManifoldPoint();
        forEachMember(point, Loader{in});
    }
    return state;
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
