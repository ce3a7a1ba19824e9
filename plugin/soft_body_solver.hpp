// The solver of soft bodies for btSoftRigidDynamicsWorld, without the work of theirs that nobody needs once Grapeshot
// finds their contacts.
#pragma once

#include <BulletSoftBody/btDefaultSoftBodySolver.h>

#include <cstdint>
#include <vector>

#include <grapeshot/plugin/precision.hpp>

class btCollisionDispatcher;
struct btDbvtNode;

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {

/// In place of btDefaultSoftBodySolver, as the world's last argument. Bodies move as with Bullet's, but that their
/// contacts come last:
/// - Bullet ends with a body's links, which draw nodes into what carries them and off it, a little in every step. Here
///   contacts are solved once more after everything else. See `setContactsLast`.
/// What else differs are the search trees of a body:
/// - of its nodes (used by Bullet's handlers of convex shapes and planes): what leaves its box is not taken out and put
///   in again, node by node, but all boxes are brought up to date from below;
/// - of its faces (used by Bullet's handler of VF_SS, which is not asked any more): there is none. It is most of the
///   first step of a fine body, because Bullet compares all its faces with all others to build it.
///   btSoftBody::rayTest looks at all faces then.
/// As long as the dispatcher is not registered, or without Settings::softPairs, everything is left to Bullet.
/// A body that is given to another solver later must be told to build the tree of its faces: m_bUpdateRtCst = true.
class SoftBodySolver : public btDefaultSoftBodySolver {
  public:
    /// @param dispatcher of the world; must outlive the solver
    explicit SoftBodySolver(const btCollisionDispatcher* dispatcher) : m_dispatcher(dispatcher) {}

    void predictMotion(btScalar seconds) override;
    void solveConstraints(btScalar seconds) override;
    /// On from the beginning. Costs as much as the contacts' part of one of a body's `piterations`; what contacts then
    /// leave of the links' work is done in the next step.
    void setContactsLast(bool wanted) { m_contactsLast = wanted; }

  private:
    [[nodiscard]] bool isOurs() const;
    void predict(btSoftBody& body, btScalar seconds);
    void updateNodeTree(btSoftBody& body);
    void solveContactsOnceMore();

    const btCollisionDispatcher* m_dispatcher;
    bool m_contactsLast = true;
    std::vector<btDbvtNode*> m_inner;
    std::vector<btVector3> m_places;
};

}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
