#include "carried_body.hpp"

#include <BulletCollision/BroadphaseCollision/btBroadphaseInterface.h>

#include <algorithm>
#include <cmath>

namespace grapeshot::soft {

using Eigen::Vector3d;

namespace {

Vector3d toEigen(const btVector3& v) {
    return {static_cast<double>(v.x()), static_cast<double>(v.y()), static_cast<double>(v.z())};
}
btVector3 toBullet(const Vector3d& v) {
    return {static_cast<btScalar>(v.x()), static_cast<btScalar>(v.y()), static_cast<btScalar>(v.z())};
}

}  // namespace

CarriedBody::CarriedBody(btSoftBodyWorldInfo& info, std::unique_ptr<btSoftBody> core, CarriedSurface surface,
                         const CarriedSettings& settings)
    : m_core(std::move(core)), m_carried(std::move(surface)), m_settings(settings) {
    m_core->m_cfg.piterations = 1;
    readCore();
    std::vector<btVector3> points;
    for (std::uint32_t v = 0; v < m_carried.vertices(); ++v) {
        points.push_back(toBullet(placeOf(m_carried, v, m_nodes.now)));
    }
    const std::vector<btScalar> fixed(points.size(), 0);
    m_surface = std::make_unique<btSoftBody>(&info, static_cast<int>(points.size()), points.data(), fixed.data());
    for (const Triangle& t : m_carried.triangles) {
        m_surface->appendFace(static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2]));
    }
    m_guard = std::make_unique<CrossingGuard>(m_carried, m_nodes);
}

void CarriedBody::readCore() {
    const int count = m_core->m_nodes.size();
    m_nodes.before.resize(static_cast<std::size_t>(count));
    m_nodes.now.resize(m_nodes.before.size());
    m_nodes.inverseMass.resize(m_nodes.before.size());
    for (int i = 0; i < count; ++i) {
        const btSoftBody::Node& node = m_core->m_nodes[i];
        const auto at = static_cast<std::size_t>(i);
        m_nodes.before[at] = toEigen(node.m_q);
        m_nodes.now[at] = toEigen(node.m_x);
        m_nodes.inverseMass[at] = static_cast<double>(node.m_im);
    }
}

void CarriedBody::writeCore() {
    for (int i = 0; i < m_core->m_nodes.size(); ++i) {
        m_core->m_nodes[i].m_x = toBullet(m_nodes.now[static_cast<std::size_t>(i)]);
    }
}

/// The surface's vertices, the end of the step before being its begin if they are those of a new one.
void CarriedBody::place(const std::vector<Vector3d>& points, bool begins) {
    const auto big = btScalar(1e18);
    btVector3 low(big, big, big), high(-big, -big, -big);
    for (std::uint32_t v = 0; v < m_carried.vertices(); ++v) {
        btSoftBody::Node& node = m_surface->m_nodes[static_cast<int>(v)];
        if (begins) {
            node.m_q = node.m_x;
        }
        node.m_x = toBullet(points[v]);
        low.setMin(node.m_x);
        low.setMin(node.m_q);
        high.setMax(node.m_x);
        high.setMax(node.m_q);
    }
    const auto margin = m_surface->getCollisionShape()->getMargin();
    m_surface->m_bounds[0] = low - btVector3(margin, margin, margin);
    m_surface->m_bounds[1] = high + btVector3(margin, margin, margin);
    if (btBroadphaseProxy* proxy = m_surface->getBroadphaseHandle()) {
        btSoftBodyWorldInfo& info = *m_surface->getWorldInfo();
        info.m_broadphase->setAabb(proxy, m_surface->m_bounds[0], m_surface->m_bounds[1], info.m_dispatcher);
    }
}

void CarriedBody::predict(btScalar seconds) {
    m_core->predictMotion(seconds);
    readCore();
    m_points.resize(m_carried.vertices());
    for (std::uint32_t v = 0; v < m_carried.vertices(); ++v) {
        m_points[v] = placeOf(m_carried, v, m_nodes.now);
    }
    place(m_points, true);
    // Bullet's solver clears them, and solves no surface of ours.
    m_surface->m_rcontacts.resize(0);
    m_surface->m_scontacts.resize(0);
}

void CarriedBody::keepAboveGround() {
    if (!m_settings.ground) {
        return;
    }
    constexpr double step = 1e-3;  // m
    for (std::size_t i = 0; i < m_nodes.now.size(); ++i) {
        Vector3d& at = m_nodes.now[i];
        const double ground = m_settings.ground(at.x(), at.z());
        if (!(m_nodes.inverseMass[i] > 0) || !(at.y() < ground + m_settings.thickness)) {
            continue;
        }
        const Vector3d normal = Vector3d(-(m_settings.ground(at.x() + step, at.z()) - ground) / step, 1,
                                         -(m_settings.ground(at.x(), at.z() + step) - ground) / step)
                                    .normalized();
        const double push = (ground + m_settings.thickness - at.y()) * normal.y();
        at += push * normal;
        Vector3d way = at - m_nodes.before[i];
        way -= way.dot(normal) * normal;
        const double length = way.norm();
        at -= length > 0 ? Vector3d(std::min(length, m_settings.friction * push) / length * way) : Vector3d::Zero();
    }
}

void CarriedBody::solve(const std::vector<SurfaceContact>& contacts, std::span<const Obstacle> obstacles,
                        btScalar seconds) {
    m_contacts = static_cast<int>(contacts.size());
    m_contactsWithRigid = static_cast<int>(
        std::count_if(contacts.begin(), contacts.end(), [](const SurfaceContact& contact) { return contact.rigid; }));
    readCore();
    m_projection.read(m_carried, contacts, m_nodes, m_settings.thickness);
    for (int round = 0; round < m_settings.rounds; ++round) {
        m_core->solveConstraints();
        for (int i = 0; i < m_core->m_nodes.size(); ++i) {
            m_nodes.now[static_cast<std::size_t>(i)] = toEigen(m_core->m_nodes[i].m_x);
        }
        keepAboveGround();
        m_projection.pass(m_nodes);
        writeCore();
    }
    for (int i = 0; i < m_settings.contactPasses; ++i) {
        m_projection.pass(m_nodes);
    }
    m_projection.rub(m_nodes, m_settings.friction);
    for (std::size_t i = 0; i < m_nodes.now.size(); ++i) {
        const Vector3d way = m_nodes.now[i] - m_nodes.before[i];
        const double length = way.norm();
        if (length > m_settings.largestStep) {
            m_nodes.now[i] = m_nodes.before[i] + m_settings.largestStep / length * way;
        }
    }
    writeCore();
    for (int i = 0; i < m_core->m_nodes.size(); ++i) {
        m_nodes.now[static_cast<std::size_t>(i)] = toEigen(m_core->m_nodes[i].m_x);  // rounded
    }
    m_guarded = m_guard->hold(m_nodes, obstacles);
    writeCore();
    const btScalar perSecond = (1 - m_core->m_cfg.kDP) / seconds;
    for (int i = 0; i < m_core->m_nodes.size(); ++i) {
        btSoftBody::Node& node = m_core->m_nodes[i];
        node.m_v = perSecond * (node.m_x - node.m_q);
    }
    m_impulse = m_projection.pushOnRigid() / static_cast<double>(seconds);
    place(m_guard->points(), false);
}

}  // namespace grapeshot::soft
