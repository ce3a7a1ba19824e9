#include "soft_demo_world.hpp"

#include <BulletSoftBody/btDeformableBodySolver.h>
#include <BulletSoftBody/btDeformableGravityForce.h>
#include <BulletSoftBody/btDeformableMassSpringForce.h>
#include <BulletSoftBody/btDeformableMultiBodyConstraintSolver.h>
#include <BulletSoftBody/btDeformableMultiBodyDynamicsWorld.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>

#include <algorithm>
#include <cmath>

#include <scenes/triangle_arrays.hpp>

#include "support/sheet_oracle.hpp"

namespace grapeshot::bench {

SoftDemoWorld::SoftDemoWorld(scenes::Engine engine, bool deformable) : m_engine(engine), m_deformable(deformable) {
    scenes::install(engine, m_dispatcher, {});
    if (deformable) {
        auto bodies = std::make_unique<btDeformableBodySolver>();
        auto solver = std::make_unique<btDeformableMultiBodyConstraintSolver>();
        solver->setDeformableSolver(bodies.get());
        auto world = std::make_unique<btDeformableMultiBodyDynamicsWorld>(&m_dispatcher, &m_broadphase, solver.get(),
                                                                          &m_configuration, bodies.get());
        world->setImplicit(false);
        world->setLineSearch(false);
        m_info = &world->getWorldInfo();
        m_softSolver = std::move(bodies);
        m_solver = std::move(solver);
        m_world = std::move(world);
        m_info->m_sparsesdf.setDefaultVoxelsz(btScalar(0.25));
    } else {
        m_softSolver = engine == scenes::Engine::grapeshot
                           ? std::unique_ptr<btSoftBodySolver>(std::make_unique<SoftBodySolver>(&m_dispatcher))
                           : std::make_unique<btDefaultSoftBodySolver>();
        m_solver = std::make_unique<btSequentialImpulseConstraintSolver>();
        auto world = std::make_unique<btSoftRigidDynamicsWorld>(&m_dispatcher, &m_broadphase, m_solver.get(),
                                                                &m_configuration, m_softSolver.get());
        m_info = &world->getWorldInfo();
        m_world = std::move(world);
    }
    m_world->getDispatchInfo().m_deterministicOverlappingPairs = true;
    m_info->m_broadphase = &m_broadphase;
    m_info->m_dispatcher = &m_dispatcher;
    m_info->air_density = btScalar(1.2);
    m_info->m_sparsesdf.Reset();
    setGravity(10);
}

SoftDemoWorld::~SoftDemoWorld() {
    for (const auto& body : m_softs) {
        if (m_deformable) {
            static_cast<btDeformableMultiBodyDynamicsWorld&>(*m_world).removeSoftBody(body.get());
        } else {
            static_cast<btSoftRigidDynamicsWorld&>(*m_world).removeSoftBody(body.get());
        }
    }
    for (const auto& body : m_rigids) {
        m_world->removeRigidBody(body.get());
    }
    m_softs.clear();
    m_world.reset();
    scenes::uninstall(m_engine, m_dispatcher);
}

void SoftDemoWorld::setGravity(btScalar downwards) {
    m_world->setGravity({0, -downwards, 0});
    m_info->m_gravity = {0, -downwards, 0};
}

btSoftBody& SoftDemoWorld::add(btSoftBody* body) {
    m_softs.emplace_back(body);
    if (m_deformable) {
        static_cast<btDeformableMultiBodyDynamicsWorld&>(*m_world).addSoftBody(body);
    } else {
        static_cast<btSoftRigidDynamicsWorld&>(*m_world).addSoftBody(body);
    }
    return *body;
}

void SoftDemoWorld::addForce(btSoftBody& body, std::unique_ptr<btDeformableLagrangianForce> force) {
    static_cast<btDeformableMultiBodyDynamicsWorld&>(*m_world).addForce(&body, force.get());
    m_forces.push_back(std::move(force));
}

btSoftBody& SoftDemoWorld::addDeformable(btSoftBody* body, btScalar stiffness, btScalar damping) {
    add(body);
    if (stiffness > 0) {
        addForce(*body, std::make_unique<btDeformableMassSpringForce>(stiffness, damping, true));
    }
    addForce(*body, std::make_unique<btDeformableGravityForce>(m_info->m_gravity));
    return *body;
}

btCollisionShape* SoftDemoWorld::keep(btCollisionShape* shape) {
    m_shapes.emplace_back(shape);
    return shape;
}

btRigidBody& SoftDemoWorld::add(btCollisionShape* shape, const btTransform& pose, btScalar mass, btScalar friction) {
    if (std::ranges::find(m_shapes, shape, &std::unique_ptr<btCollisionShape>::get) == m_shapes.end()) {
        keep(shape);
    }
    btVector3 inertia(0, 0, 0);
    if (mass > 0) {
        shape->calculateLocalInertia(mass, inertia);
    }
    btRigidBody::btRigidBodyConstructionInfo construction(mass, nullptr, shape, inertia);
    construction.m_startWorldTransform = pose;
    construction.m_friction = friction;
    m_rigids.push_back(std::make_unique<btRigidBody>(construction));
    m_world->addRigidBody(m_rigids.back().get());
    return *m_rigids.back();
}

void SoftDemoWorld::addMesh(const scenes::Mesh& mesh, const btVector3& place) {
    m_meshes.push_back(std::make_unique<scenes::Mesh>(mesh));
    m_arrays.push_back(scenes::arraysOf(m_meshes.back()->view()));
    auto* shape = new btBvhTriangleMeshShape(m_arrays.back().get(), true);
    shape->setMargin(btScalar(0.5));
    add(shape, place, 0);
}

void SoftDemoWorld::step() {
    m_world->stepSimulation(btScalar(1.0 / 60), 0);
}

bool SoftDemoWorld::isFinite() const {
    return std::ranges::all_of(m_softs, [](const auto& body) {
        for (int i = 0; i < body->m_nodes.size(); ++i) {
            const btSoftBody::Node& node = body->m_nodes[i];
            if (!std::isfinite(node.m_x.length2()) || !std::isfinite(node.m_v.length2())) {
                return false;
            }
        }
        return true;
    });
}

int SoftDemoWorld::nodes() const {
    int count = 0;
    for (const auto& body : m_softs) {
        count += body->m_nodes.size();
    }
    return count;
}

namespace {

/// Without margins; by formulas, not by the library.
bool isInside(const btCollisionShape& shape, const btVector3& p) {
    switch (shape.getShapeType()) {
        case BOX_SHAPE_PROXYTYPE: {
            const btVector3 half = static_cast<const btBoxShape&>(shape).getHalfExtentsWithoutMargin();
            return std::abs(p.x()) < half.x() && std::abs(p.y()) < half.y() && std::abs(p.z()) < half.z();
        }
        case SPHERE_SHAPE_PROXYTYPE: {
            const btScalar radius = static_cast<const btSphereShape&>(shape).getRadius();
            return p.length2() < radius * radius;
        }
        case CAPSULE_SHAPE_PROXYTYPE: {
            const auto& capsule = static_cast<const btCapsuleShape&>(shape);
            btVector3 off = p;
            btScalar& along = off[capsule.getUpAxis()];
            along -= btMax(-capsule.getHalfHeight(), btMin(capsule.getHalfHeight(), along));
            return off.length2() < capsule.getRadius() * capsule.getRadius();
        }
        case CYLINDER_SHAPE_PROXYTYPE: {
            const auto& cylinder = static_cast<const btCylinderShape&>(shape);
            const int axis = cylinder.getUpAxis();
            const btVector3 half = cylinder.getHalfExtentsWithoutMargin();
            const btScalar radius = half[(axis + 1) % 3];
            const btScalar u = p[(axis + 1) % 3];
            const btScalar v = p[(axis + 2) % 3];
            return std::abs(p[axis]) < half[axis] && u * u + v * v < radius * radius;
        }
        case COMPOUND_SHAPE_PROXYTYPE: {
            const auto& compound = static_cast<const btCompoundShape&>(shape);
            for (int i = 0; i < compound.getNumChildShapes(); ++i) {
                if (isInside(*compound.getChildShape(i), compound.getChildTransform(i).inverse() * p)) {
                    return true;
                }
            }
            return false;
        }
        default:
            return false;
    }
}

}  // namespace

int SoftDemoWorld::nodesInside() const {
    int count = 0;
    std::size_t meshes = 0;
    for (const auto& rigid : m_rigids) {
        const btCollisionShape& shape = *rigid->getCollisionShape();
        const btTransform inverse = rigid->getWorldTransform().inverse();
        std::unique_ptr<test::VerticalOracle> below;
        std::vector<Eigen::Vector3d> vertices;
        if (shape.getShapeType() == TRIANGLE_MESH_SHAPE_PROXYTYPE) {
            const scenes::Mesh& mesh = *m_meshes[meshes++];
            for (const Eigen::Vector3f& v : mesh.vertices) {
                vertices.push_back(v.cast<double>());
            }
            below = std::make_unique<test::VerticalOracle>(vertices, mesh.triangles);
        }
        for (const auto& body : m_softs) {
            for (int i = 0; i < body->m_nodes.size(); ++i) {
                const btVector3 p = inverse * body->m_nodes[i].m_x;
                const bool inside = below != nullptr ? below->at({p.x(), p.y(), p.z()}).above > 0 : isInside(shape, p);
                count += inside ? 1 : 0;
            }
        }
    }
    return count;
}

}  // namespace grapeshot::bench
