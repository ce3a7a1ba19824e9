// From contact sets to Bullet's manifolds: one manifold per region, for as long as the region lives.
#pragma once

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/BroadphaseCollision/btDispatcher.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>

#include <vector>

#include <grapeshot/adb/tree.hpp>
#include <grapeshot/narrowphase/contact_set.hpp>
#include <grapeshot/plugin/detail/manifold_state.hpp>
#include <grapeshot/plugin/detail/point_insertion.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

/// Who A and B of a contact set are.
struct ContactBodies {
    const btCollisionObjectWrapper* a = nullptr;
    const btCollisionObjectWrapper* b = nullptr;
    std::span<const MeshPart> partsA, partsB;  ///< empty: no mesh
    btScalar marginA = 0, marginB = 0;         ///< m
    bool aIsFirst = true;                      ///< A is the first body that Bullet named
    const Tree* treeA = nullptr;               ///< null: nobody asks what the triangles are
    const Tree* treeB = nullptr;
};

struct Written {
    int contacts = 0;
    int ahead = 0;  ///< of these, ahead of time
    int manifolds = 0;
    float deepest = 0;  ///< m
};

class ManifoldWriter {
  public:
    /// `shared`: the caller's manifold, which takes all points; own ones would go with a short-lived algorithm.
    ManifoldWriter(btDispatcher& dispatcher, btPersistentManifold* shared)
        : m_dispatcher(dispatcher), m_shared(shared) {}
    ~ManifoldWriter() { clear(); }
    ManifoldWriter(const ManifoldWriter&) = delete;
    ManifoldWriter& operator=(const ManifoldWriter&) = delete;

    /// Bullet's contact distance is the distance of the surfaces less both margins. `reach`: how far a point may move
    /// and still be the same, m.
    Written write(const ContactSet& now, const ContactSet& ahead, const ContactBodies& bodies, float reach,
                  btManifoldResult& result);
    /// Gives the own manifolds back.
    void clear();
    /// From within a callback: nothing more is written.
    void stop() { m_stopped = true; }
    void collect(btManifoldArray& manifolds) const;

    [[nodiscard]] std::vector<ManifoldState> saved() const;
    /// Makes a manifold with these points number `index` of the own ones. Bullet names body0 first. `adopted` comes
    /// after the last of them, in whatever order.
    void adopt(std::size_t index, const ManifoldState& state, const btCollisionObject& body0,
               const btCollisionObject& body1);
    void adopted();

  private:
    struct Own {
        btPersistentManifold* manifold = nullptr;
        std::uint32_t slot = 0;
        bool ahead = false;
        bool used = false;
        btScalar breaking = 0;  ///< its threshold as Bullet made it, m
    };
    void writeSet(const ContactSet& set, bool ahead, const ContactBodies& bodies, float reach, btManifoldResult& result,
                  Written& written);
    Own* own(std::uint32_t slot, bool ahead, const ContactBodies& bodies);

    btDispatcher& m_dispatcher;
    btPersistentManifold* m_shared;
    std::vector<Own> m_own;
    bool m_stopped = false;
};

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
