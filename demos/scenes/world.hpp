// A Bullet scene as one value: it owns everything that Bullet wants to be owned, and measures what happens in it.
#pragma once

#include <btBulletDynamicsCommon.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include <scenes/body_frame.hpp>
#include <scenes/engine.hpp>
#include <scenes/shapes.hpp>
#include <scenes/true_penetration.hpp>

namespace grapeshot::scenes {

/// Makes what collides in place of a mesh, which is given in its body frame and stays where it is. Whatever the shape
/// stands on lives as long as the pointer.
using ShapeMaker = std::function<std::shared_ptr<btCollisionShape>(const Mesh& mesh, double margin)>;

struct WorldSettings {
    Engine engine = Engine::grapeshot;
    Settings settings = {};                ///< for Engine::grapeshot
    ShapeMaker standIn = {};               ///< null: the mesh itself collides. Penetration is judged by the mesh
    Eigen::Vector3d gravity{0, -9.81, 0};  ///< m/s^2
    double timeStep = 1.0 / 60;            ///< s
    double margin = 0.02;                  ///< collision margin of meshes, m
    double friction = 0.7;                 ///< of one body; Bullet multiplies the two
    double restitution = 0;
    double rollingFriction = 0;  ///< m
    double linearDamping = 0;    ///< share of the speed lost per second
    double angularDamping = 0;
    bool sleeping = true;
    int solverIterations = 10;
    /// A body whose centre leaves this box is lost (as is one whose pose is no number), m.
    Eigen::Vector3d lower = Eigen::Vector3d::Constant(-1e3);
    Eigen::Vector3d upper = Eigen::Vector3d::Constant(1e3);
};

enum class MeshKind {
    gimpact,  ///< btGImpactMeshShape
    bvh,      ///< btBvhTriangleMeshShape, static or moving
};

struct Motion {
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< m/s
    Eigen::Vector3d spin = Eigen::Vector3d::Zero();      ///< rad/s, world frame
};

/// What one step cost and left behind.
struct StepRecord {
    double seconds = 0;  ///< whole step, wall clock
    double cpuSeconds = 0;
    double narrowphaseSeconds = 0;
    double narrowphaseCpuSeconds = 0;
    int contacts = 0;
    int manifolds = 0;
    double kineticEnergy = 0;    ///< J
    double potentialEnergy = 0;  ///< J, zero at the origin
    double rmsSpeed = 0;         ///< over the moving bodies: sqrt of the mean of v^2 + (w r)^2, m/s
    int lost = 0;                ///< bodies lost so far
    int awake = 0;               ///< moving bodies that are neither asleep nor lost
};

/// Poses of all bodies (moving and static), each of the mesh as `mesh(body)` has it.
using Frame = std::vector<PoseD>;

struct PairDepth {
    std::size_t a = 0;
    std::size_t b = 0;
    double depth = 0;  ///< true penetration, m
};

class World {
  public:
    explicit World(const WorldSettings& settings = {});
    ~World();
    World(World&&) noexcept;
    World& operator=(World&&) noexcept;

    /// Prepares a mesh for any number of bodies. It is kept in its body frame: centre of mass at the origin, principal
    /// axes along x, y, z. Throws Error for an unusable mesh.
    std::size_t addMesh(const Mesh& mesh, MeshKind kind = MeshKind::gimpact);
    /// `pose` is of the mesh as it was given; a mass of 0 makes the body static. Returns the body's index.
    std::size_t addBody(std::size_t mesh, const PoseD& pose, double mass, const Motion& motion = {});
    /// A box of Bullet's own.
    std::size_t addBox(const Eigen::Vector3d& half, const PoseD& pose, double mass, const Motion& motion = {});
    /// The half-space normal . x <= offset, static.
    std::size_t addPlane(const Eigen::Vector3d& normal, double offset);
    /// A static triangle mesh (btBvhTriangleMeshShape), open or closed.
    std::size_t addMeshFloor(const Mesh& mesh, const PoseD& pose = {});

    /// Changes velocity and spin of a body by a seeded random vector of `relative` times their length: one of the many
    /// starts that nobody could tell apart.
    void perturb(std::size_t body, double relative, std::uint64_t seed);

    /// One step of settings.timeStep.
    StepRecord step();

    [[nodiscard]] std::size_t bodies() const;
    [[nodiscard]] bool moving(std::size_t body) const;
    [[nodiscard]] bool lost(std::size_t body) const;
    [[nodiscard]] Frame poses() const;
    /// What the body looks like: its mesh in the body frame, or a mesh of the box. Empty for planes.
    [[nodiscard]] const Mesh& mesh(std::size_t body) const;
    /// Radius of the ball about the centre of mass that holds the body, m.
    [[nodiscard]] double radius(std::size_t body) const;
    [[nodiscard]] double mass(std::size_t body) const;
    [[nodiscard]] const WorldSettings& settings() const;

    /// True penetration of every pair whose boxes meet in a frame of saved poses, at least one of them moving, neither
    /// lost (outside the box of the settings in that frame). Where the static one is an open mesh, it must be flat:
    /// depth is then counted below its plane, within its outline.
    [[nodiscard]] std::vector<PairDepth> penetrations(const Frame& frame) const;
    [[nodiscard]] double deepestPenetration(const Frame& frame) const;

    [[nodiscard]] btDiscreteDynamicsWorld& dynamics();
    [[nodiscard]] TimedDispatcher& dispatcher();
    [[nodiscard]] btRigidBody& body(std::size_t index);
    [[nodiscard]] const btRigidBody& body(std::size_t index) const;

  private:
    struct State;
    std::unique_ptr<State> m_state;
};

}  // namespace grapeshot::scenes
