#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btDefaultCollisionConfiguration.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletCollision/Gimpact/btGImpactCollisionAlgorithm.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>

#include <scenes/triangle_arrays.hpp>

#include "peer.hpp"

namespace grapeshot::bench {

namespace {

struct Body {
    explicit Body(MeshView mesh) : arrays(scenes::arraysOf(mesh)) {
        shape = std::make_unique<btGImpactMeshShape>(arrays.get());
        shape->setMargin(0);
        shape->updateBound();
        object.setCollisionShape(shape.get());
    }
    [[nodiscard]] btCollisionObjectWrapper wrapper() const {
        return {nullptr, shape.get(), &object, object.getWorldTransform(), -1, -1};
    }
    std::unique_ptr<btTriangleIndexVertexArray> arrays;
    std::unique_ptr<btGImpactMeshShape> shape;
    btCollisionObject object;
};

class AnyContact : public btManifoldResult {
  public:
    using btManifoldResult::btManifoldResult;
    void addContactPoint(const btVector3& /*normal*/, const btVector3& /*point*/, btScalar /*depth*/) override {
        found = true;
    }
    bool found = false;
};

class Gimpact {
  public:
    Gimpact(MeshView a, MeshView b) : m_a(a), m_b(b), m_dispatcher(&m_configuration) {
        btGImpactCollisionAlgorithm::registerAlgorithm(&m_dispatcher);
        const btCollisionObjectWrapper first = m_a.wrapper();
        const btCollisionObjectWrapper second = m_b.wrapper();
        m_algorithm = m_dispatcher.findAlgorithm(&first, &second, nullptr, BT_CONTACT_POINT_ALGORITHMS);
    }
    Gimpact(const Gimpact&) = delete;
    Gimpact& operator=(const Gimpact&) = delete;
    ~Gimpact() {
        m_algorithm->~btCollisionAlgorithm();
        m_dispatcher.freeCollisionAlgorithm(m_algorithm);
    }

    bool decide(const Pose& bInA) {
        const Eigen::Matrix3f& r = bInA.rotation;
        const Eigen::Vector3f& t = bInA.translation;
        const btMatrix3x3 basis(r(0, 0), r(0, 1), r(0, 2), r(1, 0), r(1, 1), r(1, 2), r(2, 0), r(2, 1), r(2, 2));
        m_b.object.setWorldTransform(btTransform(basis, btVector3(t.x(), t.y(), t.z())));
        const btCollisionObjectWrapper first = m_a.wrapper();
        const btCollisionObjectWrapper second = m_b.wrapper();
        AnyContact result(&first, &second);
        m_algorithm->processCollision(&first, &second, m_info, &result);
        return result.found;
    }

  private:
    Body m_a, m_b;
    btDefaultCollisionConfiguration m_configuration;
    btCollisionDispatcher m_dispatcher;
    btDispatcherInfo m_info;
    btCollisionAlgorithm* m_algorithm = nullptr;
};

}  // namespace

Peer gimpactPeer(MeshView a, MeshView b) {
    return makePeer("GImpact",
                    [gimpact = std::make_unique<Gimpact>(a, b)](const Pose& pose) { return gimpact->decide(pose); });
}

}  // namespace grapeshot::bench
