#include "soft_world.hpp"

#include <BulletCollision/Gimpact/btGImpactShape.h>

#include <algorithm>
#include <array>
#include <string>

#include <grapeshot/core/error.hpp>
#include <report/machine.hpp>
#include <scenes/triangle_arrays.hpp>

namespace grapeshot::bench {

using Eigen::Vector3d;

namespace {

/// What Bullet makes in a body's first step, but for the face tree: it compares all faces with all others for that,
/// minutes for 70,000 of them. By insertion and from the top, as Bullet has it for rigid bodies.
void makeTrees(btSoftBody& body) {
    body.updateConstants();
    body.m_bUpdateRtCst = false;
    body.m_fdbvt.clear();
    for (int i = 0; i < body.m_faces.size(); ++i) {
        btSoftBody::Face& face = body.m_faces[i];
        const btVector3* corners[] = {&face.m_n[0]->m_x, &face.m_n[1]->m_x, &face.m_n[2]->m_x};
        btDbvtVolume volume = btDbvtVolume::FromPoints(corners, 3);
        const btScalar margin = body.getCollisionShape()->getMargin();
        volume.Expand({margin, margin, margin});
        face.m_leaf = body.m_fdbvt.insert(volume, &face);
    }
    body.m_fdbvt.optimizeTopDown();
    body.m_ndbvt.optimizeTopDown();
}

}  // namespace

template <class Solver>
class SoftWorld::Timed : public Solver {
  public:
    template <class... Arguments>
    explicit Timed(SolverTimes& times, Arguments... arguments) : Solver(arguments...), m_times(times) {}
    void solveConstraints(btScalar seconds) override {
        Solver::solveConstraints(seconds);
        m_times.solvedUs = report::threadCpuUs();
    }
    void updateSoftBodies() override {
        m_times.selfUs = report::threadCpuUs() - m_times.solvedUs;
        Solver::updateSoftBodies();
    }

  private:
    SolverTimes& m_times;
};

SoftWorld::SoftWorld(const SoftMethod& method) : m_method(method) {
    if (method.engine == scenes::Engine::grapeshot && method.ownSolver) {
        m_solver = std::make_unique<Timed<SoftBodySolver>>(m_times, &m_dispatcher);
    } else {
        m_solver = std::make_unique<Timed<btDefaultSoftBodySolver>>(m_times);
    }
    scenes::install(method.engine, m_dispatcher, method.settings);
    m_world = std::make_unique<btSoftRigidDynamicsWorld>(&m_dispatcher, &m_broadphase, &m_rigidSolver, &m_configuration,
                                                         m_solver.get());
    m_world->getDispatchInfo().m_deterministicOverlappingPairs = true;
    btSoftBodyWorldInfo& info = m_world->getWorldInfo();
    info.m_broadphase = &m_broadphase;
    info.m_dispatcher = &m_dispatcher;
    info.m_sparsesdf.Initialize();
    setGravity(9.81);
}

SoftWorld::~SoftWorld() {
    for (const btSoftBody* body : m_withThemselves) {
        static_cast<void>(removeSelfCollision(&m_dispatcher, body));
    }
    for (const Soft& soft : m_softs) {
        m_world->removeSoftBody(soft.body.get());
    }
    for (const Rigid& rigid : m_rigids) {
        m_world->removeRigidBody(rigid.body.get());
    }
    m_softs.clear();
    m_world.reset();
    scenes::uninstall(m_method.engine, m_dispatcher);
}

btSoftBody& SoftWorld::addSoft(const scenes::Mesh& mesh, double mass, double margin) {
    std::vector<btVector3> nodes;
    for (const Eigen::Vector3f& v : mesh.vertices) {
        nodes.emplace_back(v.x(), v.y(), v.z());
    }
    auto body =
        std::make_unique<btSoftBody>(&m_world->getWorldInfo(), static_cast<int>(nodes.size()), nodes.data(), nullptr);
    std::vector<std::array<int, 2>> edges;
    for (const Triangle& t : mesh.triangles) {
        const std::array corners{static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2])};
        for (std::size_t i = 0; i < 3; ++i) {
            const auto [low, high] = std::minmax(corners[i], corners[(i + 1) % 3]);
            edges.push_back({low, high});
        }
        body->appendFace(corners[0], corners[1], corners[2]);
    }
    std::ranges::sort(edges);
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    for (const auto& [from, to] : edges) {
        body->appendLink(from, to);
    }
    body->setTotalMass(btScalar(mass));
    body->m_cfg.piterations = 4;
    body->m_cfg.kDF = btScalar(0.5);
    body->m_cfg.collisions |= btSoftBody::fCollision::VF_SS;
    body->getCollisionShape()->setMargin(btScalar(margin));
    makeTrees(*body);
    m_world->addSoftBody(body.get());
    m_softs.push_back({mesh, std::move(body)});
    return *m_softs.back().body;
}

void SoftWorld::collideWithItself(btSoftBody& body) {
    if (m_method.engine == scenes::Engine::grapeshot) {
        if (const Status status = addSelfCollision(&m_dispatcher, &body); status != Status::ok) {
            throw Error(Fault::badSetting, std::string(name(status)), "addSelfCollision");
        }
        m_withThemselves.push_back(&body);
    } else if (m_method.clusters > 0) {
        // Bullet's handler looks at VF_SS first and has no self-collision there.
        body.m_cfg.collisions &= ~btSoftBody::fCollision::VF_SS;
        body.m_cfg.collisions |= btSoftBody::fCollision::CL_SS | btSoftBody::fCollision::CL_SELF;
        body.generateClusters(m_method.clusters);
    }
}

btRigidBody& SoftWorld::add(Rigid rigid, const btTransform& pose, double mass) {
    const btVector3 inertia = mass > 0 ? massProperties(rigid.shape.get(), btScalar(mass)).inertia : btVector3(0, 0, 0);
    btRigidBody::btRigidBodyConstructionInfo info(btScalar(mass), nullptr, rigid.shape.get(), inertia);
    info.m_startWorldTransform = pose;
    rigid.body = std::make_unique<btRigidBody>(info);
    rigid.body->setFriction(1);
    m_world->addRigidBody(rigid.body.get());
    m_rigids.push_back(std::move(rigid));
    return *m_rigids.back().body;
}

void SoftWorld::addMesh(const scenes::Mesh& mesh, double margin) {
    Rigid rigid;
    rigid.mesh = std::make_unique<scenes::Mesh>(mesh);
    rigid.arrays = scenes::arraysOf(rigid.mesh->view());
    rigid.shape = std::make_unique<btBvhTriangleMeshShape>(rigid.arrays.get(), true);
    rigid.shape->setMargin(btScalar(margin));
    add(std::move(rigid), btTransform::getIdentity());
}

btRigidBody& SoftWorld::throwMesh(const scenes::Mesh& mesh, double margin, const btTransform& pose,
                                  const btVector3& velocity) {
    Rigid rigid;
    rigid.mesh = std::make_unique<scenes::Mesh>(mesh);
    rigid.arrays = scenes::arraysOf(rigid.mesh->view());
    auto shape = std::make_unique<btGImpactMeshShape>(rigid.arrays.get());
    shape->setMargin(btScalar(margin));
    shape->updateBound();
    rigid.shape = std::move(shape);
    btRigidBody& body = add(std::move(rigid), pose, 1);
    body.setLinearVelocity(velocity);
    return body;
}

void SoftWorld::addGround() {
    Rigid rigid;
    rigid.shape = std::make_unique<btBoxShape>(btVector3(5, btScalar(0.5), 5));
    add(std::move(rigid), btTransform(btQuaternion::getIdentity(), {0, btScalar(-0.5), 0}));
}

void SoftWorld::setGravity(double gravity) {
    const btVector3 vector(0, btScalar(-gravity), 0);
    m_world->setGravity(vector);
    m_world->getWorldInfo().m_gravity = vector;
}

SoftStep SoftWorld::step() {
    m_dispatcher.resetClock();
    m_times.selfUs = 0;
    const double start = report::threadCpuUs();
    m_world->stepSimulation(btScalar(1.0 / 60), 0);
    SoftStep step;
    step.wholeUs = report::threadCpuUs() - start;
    step.collisionUs = m_dispatcher.cpuSeconds() * 1e6 + m_times.selfUs;
    for (const Soft& soft : m_softs) {
        step.contacts += soft.body->m_rcontacts.size() + soft.body->m_scontacts.size();
    }
    return step;
}

std::vector<Vector3d> SoftWorld::positions(std::size_t soft) const {
    const btSoftBody& body = *m_softs[soft].body;
    std::vector<Vector3d> positions;
    for (int i = 0; i < body.m_nodes.size(); ++i) {
        const btVector3& x = body.m_nodes[i].m_x;
        positions.emplace_back(x.x(), x.y(), x.z());
    }
    return positions;
}

}  // namespace grapeshot::bench
