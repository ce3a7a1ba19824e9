#include "soft_world.hpp"

#include <BulletCollision/CollisionShapes/btBvhTriangleMeshShape.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <string>

#include <grapeshot/core/error.hpp>
#include <grapeshot/plugin.hpp>
#include <report/machine.hpp>
#include <scenes/engine.hpp>
#include <scenes/triangle_arrays.hpp>

#include "carried_solver.hpp"

namespace grapeshot::soft {

using Eigen::Vector3d;

namespace {

/// The driven body is one of this mass whose path is put right before each step: so heavy that nothing turns it aside,
/// and its change of velocity tells the force on it. Bullet drops impulses on kinematic bodies.
constexpr btScalar drivenMass = 1000;  // kg

btVector3 toBullet(const Vector3d& v) {
    return {static_cast<btScalar>(v.x()), static_cast<btScalar>(v.y()), static_cast<btScalar>(v.z())};
}
Vector3d toEigen(const btVector3& v) {
    return {static_cast<double>(v.x()), static_cast<double>(v.y()), static_cast<double>(v.z())};
}
btTransform toBullet(const scenes::PoseD& pose) {
    const Eigen::Quaterniond q(pose.rotation);
    return btTransform(btQuaternion(static_cast<btScalar>(q.x()), static_cast<btScalar>(q.y()),
                                    static_cast<btScalar>(q.z()), static_cast<btScalar>(q.w())),
                       toBullet(pose.translation));
}

struct Rigid {
    scenes::Mesh mesh;
    std::unique_ptr<btTriangleIndexVertexArray> arrays;
    std::unique_ptr<btBvhTriangleMeshShape> shape;
    std::unique_ptr<btRigidBody> body;
    scenes::PoseD pose, next;
    scenes::Colour colour;
    bool driven = false;
};
struct Soft {
    std::unique_ptr<btSoftBody> own;
    std::unique_ptr<CarriedBody> carried;
    btSoftBody* body = nullptr;  // of either
    scenes::Colour colour;
};

}  // namespace

std::string_view name(Method method) noexcept {
    switch (method) {
        case Method::grapeshot:
            return "grapeshot";
        case Method::exact:
            return "exact";
        case Method::bullet:
            return "bullet";
    }
    return "unknown";
}

struct World::State {
    explicit State(Method how) : method(how) {}
    /// What carried surfaces must not pass through.
    [[nodiscard]] std::vector<Obstacle> obstacles() const;

    Method method;
    btSoftBodyRigidBodyCollisionConfiguration configuration;
    scenes::TimedDispatcher dispatcher{&configuration};
    btDbvtBroadphase broadphase;
    btSequentialImpulseConstraintSolver solver;
    CarriedSolver softSolver{dispatcher};
    btSoftRigidDynamicsWorld world{&dispatcher, &broadphase, &solver, &configuration, &softSolver};
    std::vector<std::unique_ptr<Rigid>> rigids;
    std::vector<Soft> softs;
    std::unique_ptr<ExactPeer> exact;
    double coverRadius = 0;  // m
    int compareEvery = 0;    // steps
    int steps = 0;
    std::optional<ExactComparison> comparison;
    double comparisonSeconds = 0;
};

std::vector<Obstacle> World::State::obstacles() const {
    std::vector<Obstacle> obstacles;
    for (const auto& rigid : rigids) {
        if (rigid->body == nullptr) {
            continue;
        }
        Obstacle& obstacle = obstacles.emplace_back();
        for (const Eigen::Vector3f& vertex : rigid->mesh.vertices) {
            obstacle.points.emplace_back(rigid->next.rotation * vertex.cast<double>() + rigid->next.translation);
        }
        obstacle.triangles = &rigid->mesh.triangles;
        if (rigid->driven) {
            obstacle.turn = rigid->next.rotation * rigid->pose.rotation.transpose();
            obstacle.shift = rigid->next.translation - obstacle.turn * rigid->pose.translation;
        }
    }
    return obstacles;
}

World::World(Method method, std::uint64_t sampleSeed, std::uint64_t work) : m_state(std::make_unique<State>(method)) {
    Settings settings = method == Method::exact ? Settings::exact() : Settings{};
    settings.seed = sampleSeed;
    settings.pairBudget.work = method == Method::exact ? unlimited : work;
    scenes::install(method == Method::bullet ? scenes::Engine::none : scenes::Engine::grapeshot, m_state->dispatcher,
                    settings);
    const btVector3 gravity(0, btScalar(-9.81), 0);
    m_state->world.setGravity(gravity);
    m_state->world.getDispatchInfo().m_deterministicOverlappingPairs = true;
    btSoftBodyWorldInfo& info = m_state->world.getWorldInfo();
    info.m_broadphase = &m_state->broadphase;
    info.m_dispatcher = &m_state->dispatcher;
    info.m_gravity = gravity;
    info.m_sparsesdf.Initialize();
}

World::~World() {
    for (const Soft& soft : m_state->softs) {
        static_cast<void>(removeSelfCollision(&m_state->dispatcher, soft.body));  // those that have none too
        m_state->world.removeSoftBody(soft.body);
    }
    for (const auto& rigid : m_state->rigids) {
        if (rigid->body) {
            m_state->world.removeRigidBody(rigid->body.get());
        }
    }
}

btSoftBodyWorldInfo& World::info() {
    return m_state->world.getWorldInfo();
}

btSoftBody& World::add(std::unique_ptr<btSoftBody> body, double margin, const scenes::Colour& colour, bool itself) {
    btSoftBody& added = *body;
    added.getCollisionShape()->setMargin(static_cast<btScalar>(margin));
    m_state->world.addSoftBody(&added);
    m_state->softs.push_back({std::move(body), nullptr, &added, colour});
    if (itself && m_state->method != Method::bullet) {
        if (const Status status = addSelfCollision(&m_state->dispatcher, &added); status != Status::ok) {
            throw Error(Fault::badSetting, std::string(grapeshot::name(status)), "addSelfCollision");
        }
    }
    return added;
}

btSoftBody& World::add(std::unique_ptr<CarriedBody> body, const SelfCollision& itself, const scenes::Colour& colour) {
    if (m_state->method == Method::bullet) {
        throw Error(Fault::badSetting, "bullet", "--against: nothing but contacts of ours holds a carried surface");
    }
    btSoftBody& surface = body->surface();
    surface.getCollisionShape()->setMargin(btScalar(0.5F * itself.thickness));
    m_state->world.addSoftBody(&surface);
    m_state->softSolver.add(*body);
    m_state->softs.push_back({nullptr, std::move(body), &surface, colour});
    if (const Status status = addSelfCollision(&m_state->dispatcher, &surface, itself); status != Status::ok) {
        throw Error(Fault::badSetting, std::string(grapeshot::name(status)), "addSelfCollision");
    }
    m_state->exact = std::make_unique<ExactPeer>(surface, itself);
    m_state->softSolver.whenFound = [state = m_state.get()](const btSoftBody& found,
                                                            const std::vector<SoftContact>& contacts) {
        if (state->compareEvery > 0 && state->steps % state->compareEvery == 0) {
            const double begin = report::threadCpuUs();
            state->comparison = state->exact->compare(found, contacts, state->coverRadius);
            state->comparisonSeconds = 1e-6 * (report::threadCpuUs() - begin);
        }
    };
    return surface;
}

void World::compareEvery(int steps, double radius) {
    m_state->compareEvery = steps;
    m_state->coverRadius = radius;
}

void World::addScenery(const scenes::Mesh& mesh, const scenes::Colour& colour) {
    auto rigid = std::make_unique<Rigid>();
    rigid->mesh = mesh;
    rigid->colour = colour;
    m_state->rigids.push_back(std::move(rigid));
}

std::size_t World::add(const scenes::Mesh& mesh, const scenes::PoseD& pose, bool driven, const scenes::Colour& colour) {
    auto rigid = std::make_unique<Rigid>();
    rigid->mesh = mesh;
    rigid->arrays = scenes::arraysOf(rigid->mesh.view());
    rigid->shape = std::make_unique<btBvhTriangleMeshShape>(rigid->arrays.get(), true);
    rigid->shape->setMargin(btScalar(0.005));
    rigid->pose = rigid->next = pose;
    rigid->colour = colour;
    rigid->driven = driven;
    const btScalar mass = driven ? drivenMass : 0;
    btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, rigid->shape.get(), btVector3(mass, mass, mass));
    info.m_startWorldTransform = toBullet(pose);
    info.m_friction = btScalar(0.5);
    rigid->body = std::make_unique<btRigidBody>(info);
    if (!driven) {
        m_state->world.addRigidBody(rigid->body.get());
    } else {
        // What is fixed would turn it aside.
        m_state->world.addRigidBody(rigid->body.get(), btBroadphaseProxy::DefaultFilter,
                                    btBroadphaseProxy::AllFilter ^ btBroadphaseProxy::StaticFilter);
        rigid->body->setGravity({0, 0, 0});
        rigid->body->setActivationState(DISABLE_DEACTIVATION);
    }
    m_state->rigids.push_back(std::move(rigid));
    return m_state->rigids.size() - 1;
}

void World::drive(std::size_t rigid, const scenes::PoseD& pose) {
    m_state->rigids[rigid]->next = pose;
}

StepRecord World::step() {
    State& state = *m_state;
    for (const auto& rigid : state.rigids) {
        if (rigid->driven) {
            const Eigen::AngleAxisd turn(rigid->next.rotation * rigid->pose.rotation.transpose());
            rigid->body->setWorldTransform(toBullet(rigid->pose));
            rigid->body->setInterpolationWorldTransform(toBullet(rigid->pose));
            rigid->body->setLinearVelocity(toBullet((rigid->next.translation - rigid->pose.translation) / timeStep));
            rigid->body->setAngularVelocity(toBullet(turn.axis() * (turn.angle() / timeStep)));
        }
    }
    state.softSolver.obstacles = state.obstacles();
    ++state.steps;
    state.comparison.reset();
    state.comparisonSeconds = 0;
    state.dispatcher.resetClock();
    const double begin = report::threadCpuUs();
    state.world.stepSimulation(static_cast<btScalar>(timeStep), 0);
    StepRecord record;
    record.seconds = 1e-6 * (report::threadCpuUs() - begin) - state.comparisonSeconds;
    record.exact = state.comparison;
    record.detectionSeconds = state.dispatcher.cpuSeconds();
    for (const auto& rigid : state.rigids) {
        if (rigid->driven) {
            const Vector3d asked = (rigid->next.translation - rigid->pose.translation) / timeStep;
            record.force +=
                static_cast<double>(drivenMass) * (toEigen(rigid->body->getLinearVelocity()) - asked).norm() / timeStep;
            rigid->pose = rigid->next;
        }
    }
    for (const Soft& soft : state.softs) {
        if (soft.carried) {
            record.force += soft.carried->impulseOnRigid().norm() / timeStep;
            record.held += soft.carried->guarded().held;
            record.contacts += soft.carried->contacts();
            record.contactsOfSelf += soft.carried->contacts() - soft.carried->contactsWithRigid();
        }
        record.contactsOfSelf += soft.body->m_scontacts.size();
        record.contacts += soft.body->m_scontacts.size() + soft.body->m_rcontacts.size();
    }
    if (state.method != Method::bullet) {
        const StepStatistics& stats = statistics(&state.dispatcher);
        record.work = static_cast<double>(stats.work);
        record.sampled = stats.sampled;
        for (const PairStatistics& pair : stats.pairs) {
            record.missBound = std::max(record.missBound, pair.missBound);
        }
    }
    return record;
}

Method World::method() const {
    return m_state->method;
}
std::size_t World::softBodies() const {
    return m_state->softs.size();
}
std::size_t World::rigidBodies() const {
    return m_state->rigids.size();
}
const btSoftBody& World::soft(std::size_t index) const {
    return *m_state->softs[index].body;
}
btSoftBody& World::soft(std::size_t index) {
    return *m_state->softs[index].body;
}
const scenes::Colour& World::softColour(std::size_t index) const {
    return m_state->softs[index].colour;
}
const scenes::Colour& World::rigidColour(std::size_t index) const {
    return m_state->rigids[index]->colour;
}

Surface World::softSurface(std::size_t index) const {
    const btSoftBody& body = soft(index);
    Surface surface;
    for (int i = 0; i < body.m_nodes.size(); ++i) {
        surface.points.push_back(toEigen(body.m_nodes[i].m_x));
    }
    for (int i = 0; i < body.m_faces.size(); ++i) {
        const auto& corners = body.m_faces[i].m_n;
        const auto at = [&](int k) { return static_cast<std::uint32_t>(corners[k] - &body.m_nodes[0]); };
        surface.triangles.push_back({at(0), at(1), at(2)});
    }
    return surface;
}

Surface World::rigidSurface(std::size_t index) const {
    const Rigid& rigid = *m_state->rigids[index];
    Surface surface;
    for (const Eigen::Vector3f& vertex : rigid.mesh.vertices) {
        surface.points.emplace_back(rigid.pose.rotation * vertex.cast<double>() + rigid.pose.translation);
    }
    surface.triangles = rigid.mesh.triangles;
    return surface;
}

std::size_t World::triangles() const {
    std::size_t sum = 0;
    for (const Soft& each : m_state->softs) {
        sum += static_cast<std::size_t>(each.body->m_faces.size());
    }
    return sum;
}

}  // namespace grapeshot::soft
