#include "world.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <deque>
#include <limits>
#include <numbers>
#include <optional>
#include <string>

#include <grapeshot/core/mesh_report.hpp>
#include <grapeshot/core/random.hpp>
#include <report/machine.hpp>
#include <scenes/detail/body_shapes.hpp>
#include <scenes/detail/convert.hpp>

namespace grapeshot::scenes {

using detail::fromBullet;
using detail::toBullet;
using Eigen::Vector3d;

namespace {

enum class BodyKind { mesh, box, plane };

struct MeshEntry {
    Mesh mesh;  ///< in its body frame
    BodyFrame frame;
    detail::MeshShape shape;
    std::shared_ptr<btCollisionShape> standIn;  ///< collides in its place, if there is one
    std::optional<TrueSurface> surface;         ///< built when first asked for
    double radius = 0;

    [[nodiscard]] btCollisionShape& collides() const { return standIn ? *standIn : *shape.shape; }
};

struct Body {
    BodyKind kind = BodyKind::mesh;
    std::size_t mesh = 0;                 ///< kind mesh and box: what it looks like
    Vector3d half = Vector3d::Zero();     ///< kind box
    Vector3d normal = Vector3d::UnitY();  ///< kind plane
    double offset = 0;
    double mass = 0;
    std::unique_ptr<btCollisionShape> ownShape;
    std::unique_ptr<btRigidBody> rigid;
    bool lost = false;
};

PoseD bodyPose(const PoseD& meshPose, const BodyFrame& frame) {
    return {meshPose.rotation * frame.axes, meshPose.rotation * frame.centre + meshPose.translation};
}

double radiusOf(const Mesh& mesh) {
    double squared = 0;
    for (const Eigen::Vector3f& v : mesh.vertices) {
        squared = std::max(squared, v.cast<double>().squaredNorm());
    }
    return std::sqrt(squared);
}

}  // namespace

struct World::State {
    explicit State(const WorldSettings& given) : settings(given) {
        configuration = std::make_unique<btDefaultCollisionConfiguration>();
        dispatcher = std::make_unique<TimedDispatcher>(configuration.get());
        install(settings.engine, *dispatcher, settings.settings);
        broadphase = std::make_unique<btDbvtBroadphase>();
        solver = std::make_unique<btSequentialImpulseConstraintSolver>();
        dynamics = std::make_unique<btDiscreteDynamicsWorld>(dispatcher.get(), broadphase.get(), solver.get(),
                                                             configuration.get());
        dynamics->setGravity(toBullet(Vector3d(settings.gravity.cast<double>())));
        dynamics->getSolverInfo().m_numIterations = settings.solverIterations;
        dynamics->getDispatchInfo().m_deterministicOverlappingPairs = true;
    }

    // Bullet's order: bodies leave the world, the world goes before its dispatcher, bodies before their shapes.
    ~State() {
        for (const Body& entry : bodies) {
            dynamics->removeRigidBody(entry.rigid.get());
        }
        dynamics.reset();
        uninstall(settings.engine, *dispatcher);
    }

    std::size_t add(Body entry, btCollisionShape& shape, const PoseD& pose, const Vector3d& inertia,
                    const Motion& motion);
    const TrueSurface& surface(std::size_t mesh);
    [[nodiscard]] bool outside(const PoseD& pose) const;
    [[nodiscard]] double depth(const Body& a, const PoseD& poseA, const Body& b, const PoseD& poseB);
    [[nodiscard]] double depthBelowSheet(const Body& moving, const PoseD& pose, const Body& sheet,
                                         const PoseD& sheetPose);
    void measure(StepRecord& record);

    WorldSettings settings;
    std::deque<MeshEntry> meshes;  ///< a deque: Bullet keeps pointers into the meshes
    std::unique_ptr<btDefaultCollisionConfiguration> configuration;
    std::unique_ptr<TimedDispatcher> dispatcher;
    std::unique_ptr<btDbvtBroadphase> broadphase;
    std::unique_ptr<btSequentialImpulseConstraintSolver> solver;
    std::unique_ptr<btDiscreteDynamicsWorld> dynamics;
    std::vector<Body> bodies;
};

std::size_t World::State::add(Body entry, btCollisionShape& shape, const PoseD& pose, const Vector3d& inertia,
                              const Motion& motion) {
    btRigidBody::btRigidBodyConstructionInfo info(static_cast<btScalar>(entry.mass), nullptr, &shape,
                                                  toBullet(inertia));
    info.m_startWorldTransform = toBullet(pose);
    info.m_friction = static_cast<btScalar>(settings.friction);
    info.m_restitution = static_cast<btScalar>(settings.restitution);
    info.m_rollingFriction = static_cast<btScalar>(settings.rollingFriction);
    info.m_linearDamping = static_cast<btScalar>(settings.linearDamping);
    info.m_angularDamping = static_cast<btScalar>(settings.angularDamping);
    entry.rigid = std::make_unique<btRigidBody>(info);
    entry.rigid->setLinearVelocity(toBullet(motion.velocity));
    entry.rigid->setAngularVelocity(toBullet(motion.spin));
    if (!settings.sleeping && entry.mass > 0) {
        entry.rigid->setActivationState(DISABLE_DEACTIVATION);
    }
    dynamics->addRigidBody(entry.rigid.get());
    bodies.push_back(std::move(entry));
    return bodies.size() - 1;
}

const TrueSurface& World::State::surface(std::size_t mesh) {
    MeshEntry& entry = meshes[mesh];
    if (!entry.surface) {
        entry.surface.emplace(entry.mesh.view());
    }
    return *entry.surface;
}

bool World::State::outside(const PoseD& pose) const {
    const Vector3d& p = pose.translation;
    // Written so that a NaN is outside.
    return !((p.array() >= settings.lower.array()).all() && (p.array() <= settings.upper.array()).all() &&
             pose.rotation.allFinite());
}

World::World(const WorldSettings& settings) : m_state(std::make_unique<State>(settings)) {}
World::~World() = default;
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;

std::size_t World::addMesh(const Mesh& mesh, MeshKind kind) {
    requireUsable(mesh.view());
    MeshEntry& entry = m_state->meshes.emplace_back();
    entry.frame = bodyFrame(mesh);
    entry.mesh = inBodyFrame(mesh, entry.frame);
    entry.radius = radiusOf(entry.mesh);
    const double margin = m_state->settings.margin;
    if (m_state->settings.standIn) {
        entry.standIn = m_state->settings.standIn(entry.mesh, margin);
        if (entry.standIn->isConcave()) {
            prepare(m_state->settings.engine, *entry.standIn);
        }
    } else if (m_state->settings.engine == Engine::hull) {
        entry.shape = detail::hullShape(entry.mesh, margin);
    } else {
        entry.shape =
            kind == MeshKind::bvh ? detail::bvhShape(entry.mesh, margin) : detail::gimpactShape(entry.mesh, margin);
        prepare(m_state->settings.engine, *entry.shape.shape, m_state->settings.settings.method);
    }
    return m_state->meshes.size() - 1;
}

std::size_t World::addBody(std::size_t mesh, const PoseD& pose, double mass, const Motion& motion) {
    MeshEntry& entry = m_state->meshes.at(mesh);
    Body body;
    body.mesh = mesh;
    body.mass = mass;
    return m_state->add(std::move(body), entry.collides(), bodyPose(pose, entry.frame), mass * entry.frame.unitInertia,
                        motion);
}

std::size_t World::addBox(const Vector3d& half, const PoseD& pose, double mass, const Motion& motion) {
    MeshEntry& entry = m_state->meshes.emplace_back();
    entry.mesh = box(half.cast<float>());
    entry.radius = half.norm();
    Body body;
    body.kind = BodyKind::box;
    body.mesh = m_state->meshes.size() - 1;
    body.half = half;
    body.mass = mass;
    body.ownShape = std::make_unique<btBoxShape>(toBullet(half));
    const Vector3d squares = half.cwiseAbs2();
    const Vector3d inertia = mass / 3 * (Vector3d::Constant(squares.sum()) - squares);
    btCollisionShape& shape = *body.ownShape;
    return m_state->add(std::move(body), shape, pose, inertia, motion);
}

std::size_t World::addPlane(const Vector3d& normal, double offset) {
    Body body;
    body.kind = BodyKind::plane;
    m_state->meshes.emplace_back();
    body.mesh = m_state->meshes.size() - 1;
    body.normal = normal;
    body.offset = offset;
    body.ownShape = std::make_unique<btStaticPlaneShape>(toBullet(normal), static_cast<btScalar>(offset));
    btCollisionShape& shape = *body.ownShape;
    return m_state->add(std::move(body), shape, {}, Vector3d::Zero(), {});
}

std::size_t World::addMeshFloor(const Mesh& mesh, const PoseD& pose) {
    requireUsable(mesh.view());
    MeshEntry& entry = m_state->meshes.emplace_back();
    entry.mesh = mesh;
    entry.radius = radiusOf(mesh);
    entry.shape = detail::bvhShape(entry.mesh, m_state->settings.margin);
    prepare(m_state->settings.engine, *entry.shape.shape, m_state->settings.settings.method);
    Body body;
    body.mesh = m_state->meshes.size() - 1;
    return m_state->add(std::move(body), *entry.shape.shape, pose, Vector3d::Zero(), {});
}

void World::perturb(std::size_t body, double relative, std::uint64_t seed) {
    btRigidBody& rigid = *m_state->bodies.at(body).rigid;
    std::uint32_t draw = 0;
    const auto direction = [&]() -> Vector3d {
        const RandomKey key{.seed = seed, .pair = body, .step = 0};
        const double y = 2.0 * randomUnit(key, draw++) - 1;
        const double longitude = 2 * std::numbers::pi * randomUnit(key, draw++);
        const double r = std::sqrt(1 - y * y);
        return {r * std::cos(longitude), y, r * std::sin(longitude)};
    };
    const Vector3d velocity = fromBullet(rigid.getLinearVelocity());
    const Vector3d spin = fromBullet(rigid.getAngularVelocity());
    rigid.setLinearVelocity(toBullet(Vector3d(velocity + relative * velocity.norm() * direction())));
    rigid.setAngularVelocity(toBullet(Vector3d(spin + relative * spin.norm() * direction())));
}

StepRecord World::step() {
    StepRecord record;
    m_state->dispatcher->resetClock();
    const double wall = report::wallUs();
    const double cpu = report::threadCpuUs();
    m_state->dynamics->stepSimulation(static_cast<btScalar>(m_state->settings.timeStep), 0);
    record.seconds = 1e-6 * (report::wallUs() - wall);
    record.cpuSeconds = 1e-6 * (report::threadCpuUs() - cpu);
    record.narrowphaseSeconds = m_state->dispatcher->seconds();
    record.narrowphaseCpuSeconds = m_state->dispatcher->cpuSeconds();
    m_state->measure(record);
    return record;
}

void World::State::measure(StepRecord& record) {
    record.manifolds = dispatcher->getNumManifolds();
    for (int m = 0; m < record.manifolds; ++m) {
        record.contacts += dispatcher->getManifoldByIndexInternal(m)->getNumContacts();
    }
    double squaredSpeeds = 0;
    int moving = 0;
    for (Body& entry : bodies) {
        if (entry.mass <= 0) {
            continue;
        }
        const PoseD pose = fromBullet(entry.rigid->getWorldTransform());
        entry.lost = entry.lost || outside(pose);
        if (entry.lost) {
            ++record.lost;
            continue;
        }
        record.awake += entry.rigid->isActive() ? 1 : 0;
        const Vector3d v = fromBullet(entry.rigid->getLinearVelocity());
        const Vector3d w = fromBullet(entry.rigid->getAngularVelocity());
        const Vector3d inBody = pose.rotation.transpose() * w;
        const Vector3d inertia = fromBullet(entry.rigid->getLocalInertia());
        record.kineticEnergy +=
            0.5 * entry.mass * v.squaredNorm() + 0.5 * inBody.cwiseAbs2().cwiseProduct(inertia).sum();
        record.potentialEnergy -= entry.mass * settings.gravity.cast<double>().dot(pose.translation);
        const double rim = w.norm() * meshes[entry.mesh].radius;
        squaredSpeeds += v.squaredNorm() + rim * rim;
        ++moving;
    }
    record.rmsSpeed = moving > 0 ? std::sqrt(squaredSpeeds / moving) : 0;
}

std::size_t World::bodies() const {
    return m_state->bodies.size();
}
bool World::moving(std::size_t body) const {
    return m_state->bodies.at(body).mass > 0;
}
bool World::lost(std::size_t body) const {
    return m_state->bodies.at(body).lost;
}
const Mesh& World::mesh(std::size_t body) const {
    return m_state->meshes[m_state->bodies.at(body).mesh].mesh;
}
double World::radius(std::size_t body) const {
    return m_state->meshes[m_state->bodies.at(body).mesh].radius;
}
double World::mass(std::size_t body) const {
    return m_state->bodies.at(body).mass;
}
const WorldSettings& World::settings() const {
    return m_state->settings;
}
btDiscreteDynamicsWorld& World::dynamics() {
    return *m_state->dynamics;
}
TimedDispatcher& World::dispatcher() {
    return *m_state->dispatcher;
}
btRigidBody& World::body(std::size_t index) {
    return *m_state->bodies.at(index).rigid;
}
const btRigidBody& World::body(std::size_t index) const {
    return *m_state->bodies.at(index).rigid;
}

Frame World::poses() const {
    Frame frame;
    for (const Body& entry : m_state->bodies) {
        frame.push_back(fromBullet(entry.rigid->getWorldTransform()));
    }
    return frame;
}

double World::State::depthBelowSheet(const Body& moving, const PoseD& pose, const Body& sheet, const PoseD& sheetPose) {
    const Mesh& mesh = meshes[sheet.mesh].mesh;
    const TrueSurface& outline = surface(sheet.mesh);
    int across = 0;
    if ((outline.upper() - outline.lower()).minCoeff(&across) > 1e-6) {
        return 0;  // not flat
    }
    const Triangle& first = mesh.triangles.front();
    const Eigen::Vector3f edge = mesh.vertices[first[1]] - mesh.vertices[first[0]];
    const double facing = edge.cross(mesh.vertices[first[2]] - mesh.vertices[first[0]])[across] < 0 ? -1 : 1;
    double depth = 0;
    for (const Vector3d& sample : surface(moving.mesh).samples()) {
        const Vector3d world = pose.rotation * sample + pose.translation;
        const Vector3d p = sheetPose.rotation.transpose() * (world - sheetPose.translation);
        bool within = true;
        for (int axis = 0; axis < 3; ++axis) {
            within =
                within && (axis == across || (p[axis] >= outline.lower()[axis] && p[axis] <= outline.upper()[axis]));
        }
        if (within) {
            depth = std::max(depth, facing * (outline.lower()[across] - p[across]));
        }
    }
    return depth;
}

double World::State::depth(const Body& a, const PoseD& poseA, const Body& b, const PoseD& poseB) {
    if (b.kind == BodyKind::plane) {
        return penetrationBelowPlane(surface(a.mesh), poseA, b.normal, b.offset);
    }
    if (a.mass > 0 && b.mass <= 0 && b.kind == BodyKind::mesh && !surface(b.mesh).closed()) {
        return depthBelowSheet(a, poseA, b, poseB);
    }
    return truePenetration(surface(a.mesh), poseA, surface(b.mesh), poseB);
}

std::vector<PairDepth> World::penetrations(const Frame& frame) const {
    State& state = *m_state;
    assert(frame.size() == state.bodies.size());
    std::vector<PairDepth> result;
    for (std::size_t i = 0; i < frame.size(); ++i) {
        for (std::size_t j = i + 1; j < frame.size(); ++j) {
            // The moving one first; a static one stands still where it may, beyond the box.
            const bool swap = state.bodies[i].mass <= 0;
            const std::size_t first = swap ? j : i;
            const std::size_t second = swap ? i : j;
            const Body& a = state.bodies[first];
            const Body& b = state.bodies[second];
            if (a.mass <= 0 || state.outside(frame[first]) || (b.mass > 0 && state.outside(frame[second]))) {
                continue;
            }
            const double reach = state.meshes[a.mesh].radius + state.meshes[b.mesh].radius;
            const bool bounded = b.kind != BodyKind::plane;
            if (bounded && (frame[first].translation - frame[second].translation).norm() > reach) {
                continue;
            }
            result.push_back({first, second, state.depth(a, frame[first], b, frame[second])});
        }
    }
    return result;
}

double World::deepestPenetration(const Frame& frame) const {
    double deepest = 0;
    for (const PairDepth& pair : penetrations(frame)) {
        deepest = std::max(deepest, pair.depth);
    }
    return deepest;
}

}  // namespace grapeshot::scenes
