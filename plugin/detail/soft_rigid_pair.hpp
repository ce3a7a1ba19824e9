// A soft body against one rigid mesh, from step to step.
#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletSoftBody/btSoftBody.h>

#include <memory>
#include <string>
#include <vector>

#include <grapeshot/plugin/detail/context.hpp>
#include <grapeshot/plugin/detail/near_pairs.hpp>
#include <grapeshot/plugin/detail/rigid_contact_writer.hpp>
#include <grapeshot/plugin/detail/rigid_surface.hpp>
#include <grapeshot/plugin/detail/soft_surface.hpp>
#include <grapeshot/plugin/soft_contacts.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

/// Which of Bullet's soft solvers a body is for, by its collision flags.
enum class SoftWorld {
    positions,   ///< SDF_RS: btSoftRigidDynamicsWorld
    velocities,  ///< SDF_RD: btDeformableMultiBodyDynamicsWorld
    neither,     ///< clusters, or nothing: not ours
};
[[nodiscard]] SoftWorld rigidWorldOf(const btSoftBody& body);

/// What one pair of a step did.
struct SoftPairResult {
    NearResult near;
    std::size_t pairs = 0;  ///< of triangles whose features were tested
    int contacts = 0;       ///< written
    int crossings = 0;
    float deepest = 0;
    std::string refusal;  ///< why there was no answer; else empty
};

/// Nodes and weights of one side, in the words of the public header.
[[nodiscard]] SoftContact toldOf(const std::array<std::uint32_t, 3>& vertices, const Eigen::Vector3f& weights,
                                 std::uint32_t nodes);

class SoftRigidPair {
  public:
    explicit SoftRigidPair(Context& context) : m_context(context) {}

    SoftPairResult process(btSoftBody& soft, const btCollisionObjectWrapper& rigid, btScalar timeStep,
                           std::uint64_t look, std::uint64_t key, const Budget& budget);
    void forget();
    /// Those of the last step, if it is the body's pair.
    void appendContacts(const btSoftBody& body, std::vector<SoftContact>& contacts) const;

  private:
    bool findSurfaces(const btSoftBody& soft, const btCollisionShape& shape, std::uint64_t look, std::string& refusal);
    bool readPositions(const btSoftBody& soft, const btTransform& from, const btTransform& to, btScalar timeStep,
                       SoftWorld world);
    void forgetIfMoved();
    /// Where nodes will be if they make way for the rigid body by no more than their links let them.
    void holdNodes(const btSoftBody& soft, const btTransform& from, const btTransform& to, float distance);
    int write(btSoftBody& soft, const btCollisionObjectWrapper& rigid, const btTransform& frame,
              const btVector3& origin, float distance, SoftWorld world);
    /// Contacts of its nodes in btSoftRigidDynamicsWorld.
    int writeStops(const RigidContactSite& site, float distance, const MovableBodies& movable);

    Context& m_context;
    const btSoftBody* m_body = nullptr;
    const btCollisionShape* m_shape = nullptr;
    std::shared_ptr<SoftEntry> m_softEntry;
    std::shared_ptr<ShapeEntry> m_shapeEntry;
    std::shared_ptr<const ShapeModel> m_model;
    std::shared_ptr<const SoftSurface> m_soft;
    std::shared_ptr<const RigidSurface> m_rigid;
    std::unique_ptr<NearPairs> m_near;
    SurfaceContacts m_sides;
    std::vector<Eigen::Vector3f> m_last, m_before, m_after, m_held;
    const btCollisionObject* m_object = nullptr;
    btMatrix3x3 m_frame;   // of m_contacts
    float m_usualWay = 0;  // most that a vertex was to move in the last step, m
    std::vector<TrianglePair> m_pairs;
    std::vector<SoftSurfaceContact> m_contacts;
};

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
