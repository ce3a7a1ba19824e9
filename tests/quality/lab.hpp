// What the experiments of this folder have in common: one moving body on a floor.
//
// Margins: a mesh body keeps the sum of both margins from whatever it rests on, as everywhere in Bullet (a box of
// Bullet's own has its margin inside). Formulas count that gap; it is small against the bodies, so that neither engine
// gains by it, and both get the same.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>

#include <scenes/world.hpp>

namespace grapeshot::test {

inline constexpr double gravity = 9.81;  ///< m/s^2
inline constexpr double margin = 0.005;  ///< m, of meshes

enum class Floor { plane, mesh, box };
enum class Body { mesh, primitive };

/// A method, and what its searches may cost a pair in a step.
struct Way {
    const char* name;
    Method method;
    std::uint64_t searchWork;
    [[nodiscard]] Settings settings() const {
        Settings settings;
        settings.method = method;
        settings.searchWork = searchWork;
        return settings;
    }
};
inline constexpr std::uint64_t usualSearchWork = 4096;
inline constexpr std::array ways{Way{"automatic", Method::automatic, usualSearchWork},
                                 Way{"adb", Method::adb, usualSearchWork}, Way{"scf", Method::scf, usualSearchWork},
                                 Way{"sampled", Method::scf, 256}};

inline scenes::WorldSettings labSettings(scenes::Engine engine = scenes::Engine::grapeshot) {
    scenes::WorldSettings settings;
    settings.engine = engine;
    settings.margin = margin;
    settings.sleeping = false;
    settings.timeStep = 1.0 / 240;
    return settings;
}

/// Top of the floor at y = 0; the mesh is cut into cells of 1/3 m, so that bodies cross many inner edges.
inline void addFloor(scenes::World& world, Floor floor, double halfX = 8, double halfZ = 2) {
    switch (floor) {
        case Floor::plane:
            world.addPlane(Eigen::Vector3d::UnitY(), 0);
            break;
        case Floor::mesh:
            world.addMeshFloor(scenes::grid(static_cast<float>(halfX), static_cast<float>(halfZ),
                                            static_cast<int>(6 * halfX), static_cast<int>(6 * halfZ)));
            break;
        case Floor::box:
            world.addBox({halfX, 0.5, halfZ}, {Eigen::Matrix3d::Identity(), {0, -0.5, 0}}, 0);
            break;
    }
}

/// How far the surface of a resting body is above the floor.
inline double restGap(Body body, Floor floor, double meshMargin = margin) {
    return (body == Body::mesh ? meshMargin : 0) + (floor == Floor::mesh ? meshMargin : 0);
}

inline scenes::PoseD at(const Eigen::Vector3d& position, double yaw = 0) {
    return {Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitY()).toRotationMatrix(), position};
}

inline Eigen::Vector3d position(const btRigidBody& body) {
    const btVector3& p = body.getWorldTransform().getOrigin();
    return {p.x(), p.y(), p.z()};
}

inline Eigen::Vector3d velocity(const btRigidBody& body) {
    const btVector3& v = body.getLinearVelocity();
    return {v.x(), v.y(), v.z()};
}

/// Bullet's own sphere in a world, with the same inertia and material that a mesh sphere gets.
class PrimitiveSphere {
  public:
    PrimitiveSphere(scenes::World& world, double radius, const Eigen::Vector3d& position)
        : m_world(world), m_shape(static_cast<btScalar>(radius)) {
        const auto inertia = static_cast<btScalar>(0.4 * radius * radius);
        btRigidBody::btRigidBodyConstructionInfo info(1, nullptr, &m_shape, {inertia, inertia, inertia});
        info.m_startWorldTransform.setIdentity();
        info.m_startWorldTransform.setOrigin({static_cast<btScalar>(position.x()), static_cast<btScalar>(position.y()),
                                              static_cast<btScalar>(position.z())});
        info.m_friction = static_cast<btScalar>(world.settings().friction);
        info.m_restitution = static_cast<btScalar>(world.settings().restitution);
        m_body = std::make_unique<btRigidBody>(info);
        m_body->setActivationState(DISABLE_DEACTIVATION);
        world.dynamics().addRigidBody(m_body.get());
    }
    ~PrimitiveSphere() { m_world.dynamics().removeRigidBody(m_body.get()); }
    PrimitiveSphere(const PrimitiveSphere&) = delete;
    PrimitiveSphere& operator=(const PrimitiveSphere&) = delete;
    btRigidBody& body() { return *m_body; }

  private:
    scenes::World& m_world;
    btSphereShape m_shape;
    std::unique_ptr<btRigidBody> m_body;
};

}  // namespace grapeshot::test
