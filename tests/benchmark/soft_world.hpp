// A Bullet world with soft bodies that measures its steps: whole, and what of them is collision.
#pragma once

#include <BulletSoftBody/btDefaultSoftBodySolver.h>
#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>

#include <memory>
#include <string>
#include <vector>

#include <scenes/engine.hpp>
#include <scenes/shapes.hpp>

namespace grapeshot::bench {

/// Who finds the contacts of soft bodies.
struct SoftMethod {
    std::string name;
    scenes::Engine engine = scenes::Engine::grapeshot;  ///< none: Bullet's own handlers
    Settings settings = {};
    bool ownSolver = true;  ///< grapeshot::SoftBodySolver; else Bullet's
    int clusters = 0;       ///< of a body that is to collide with itself, by Bullet; 0: it is not asked to
};

/// Processor time of one step, us.
struct SoftStep {
    double wholeUs = 0;
    double collisionUs =
        0;             ///< dispatch, and Bullet's handler of bodies against themselves, which runs after the solver
    int contacts = 0;  ///< as the solver got them
};

class SoftWorld {
  public:
    /// Throws Error (badSetting) if the library refuses the settings.
    explicit SoftWorld(const SoftMethod& method);
    ~SoftWorld();
    SoftWorld(const SoftWorld&) = delete;
    SoftWorld& operator=(const SoftWorld&) = delete;

    /// Vertices become nodes, edges links: node i is vertex i, face t triangle t. It collides with rigid bodies and
    /// with soft ones. @param margin m @param mass kg
    btSoftBody& addSoft(const scenes::Mesh& mesh, double mass, double margin);
    /// By whatever the method has for that.
    void collideWithItself(btSoftBody& body);
    /// Static, btBvhTriangleMeshShape.
    void addMesh(const scenes::Mesh& mesh, double margin);
    /// btGImpactMeshShape of 1 kg on its way, m/s.
    btRigidBody& throwMesh(const scenes::Mesh& mesh, double margin, const btTransform& pose, const btVector3& velocity);
    /// Static, its top at y = 0.
    void addGround();

    /// Downwards, m/s^2; 9.81 if nothing is said.
    void setGravity(double gravity);

    /// 1/60 s.
    SoftStep step();

    [[nodiscard]] btSoftBody& soft(std::size_t index) { return *m_softs[index].body; }
    [[nodiscard]] const scenes::Mesh& mesh(std::size_t soft) const { return m_softs[soft].mesh; }
    [[nodiscard]] std::vector<Eigen::Vector3d> positions(std::size_t soft) const;
    /// Of the last step; all zero under Bullet's own.
    [[nodiscard]] const StepStatistics& ours() const { return statistics(&m_dispatcher); }

  private:
    /// The handler of bodies against themselves runs between these two and cannot be overridden.
    struct SolverTimes {
        double solvedUs = 0;
        double selfUs = 0;
    };
    template <class Solver>
    class Timed;
    struct Soft {
        scenes::Mesh mesh;
        std::unique_ptr<btSoftBody> body;
    };
    struct Rigid {
        std::unique_ptr<scenes::Mesh> mesh;
        std::unique_ptr<btStridingMeshInterface> arrays;
        std::unique_ptr<btCollisionShape> shape;
        std::unique_ptr<btRigidBody> body;
    };
    btRigidBody& add(Rigid rigid, const btTransform& pose, double mass = 0);

    SoftMethod m_method;
    btSoftBodyRigidBodyCollisionConfiguration m_configuration;
    scenes::TimedDispatcher m_dispatcher{&m_configuration};
    btDbvtBroadphase m_broadphase;
    btSequentialImpulseConstraintSolver m_rigidSolver;
    SolverTimes m_times;
    std::unique_ptr<btSoftBodySolver> m_solver;
    std::unique_ptr<btSoftRigidDynamicsWorld> m_world;
    std::vector<Rigid> m_rigids;
    std::vector<Soft> m_softs;
    std::vector<const btSoftBody*> m_withThemselves;
};

}  // namespace grapeshot::bench
