// A fine surface that a coarse soft body carries: the body is simulated, the surface collides.
//
// The surface is a soft body of its own in Bullet's world, of fixed nodes: Bullet neither moves nor answers for it. Its
// contacts are asked of the library, and the coarse nodes below them keep them.
//
// This work is based on:
// Matthias Müller, Bruno Heidelberger, Marcus Hennix, John Ratcliff. Position Based Dynamics. VRIPHYS 2006
#pragma once

#include <BulletSoftBody/btSoftBody.h>

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include <grapeshot/core/mesh_view.hpp>

#include "contact_projection.hpp"
#include "crossing_guard.hpp"

namespace grapeshot::soft {

struct CarriedSettings {
    double thickness = 0.02;    ///< of two layers, m
    double largestStep = 0.01;  ///< no node moves farther in a step, m: what keeps contacts ahead of it in reach
    int rounds = 10;            ///< of links and contacts in turns
    int contactPasses = 4;      ///< more, of contacts alone, at the end
    double friction = 0.1;
    /// Height of the ground, which coarse nodes stay above, by x and z, m; may be empty.
    std::function<double(double, double)> ground;
};

class CarriedBody {
  public:
    /// @param core with its links; not in a world. Its faces are of no use.
    CarriedBody(btSoftBodyWorldInfo& info, std::unique_ptr<btSoftBody> core, CarriedSurface surface,
                const CarriedSettings& settings);

    /// In place of btSoftBody::predictMotion.
    void predict(btScalar seconds);
    /// In place of btSoftBody::solveConstraints. @param contacts of the surface in this step @param obstacles that it
    /// must not pass through
    void solve(const std::vector<SurfaceContact>& contacts, std::span<const Obstacle> obstacles, btScalar seconds);
    [[nodiscard]] btSoftBody& core() { return *m_core; }
    /// To be added to the world, and removed before this goes.
    [[nodiscard]] btSoftBody& surface() { return *m_surface; }
    /// Impulse over the step that rigid bodies have felt, sum over all contacts with them, N s.
    [[nodiscard]] const Eigen::Vector3d& impulseOnRigid() const { return m_impulse; }

    [[nodiscard]] int contacts() const { return m_contacts; }
    /// What the last step's ways were shortened by.
    [[nodiscard]] const GuardResult& guarded() const { return m_guarded; }
    [[nodiscard]] int contactsWithRigid() const { return m_contactsWithRigid; }

  private:
    void place(const std::vector<Eigen::Vector3d>& points, bool begins);
    void readCore();
    void writeCore();
    void keepAboveGround();

    std::unique_ptr<btSoftBody> m_core, m_surface;
    CarriedSurface m_carried;
    CarriedSettings m_settings;
    ContactProjection m_projection;
    CoreNodes m_nodes;
    std::unique_ptr<CrossingGuard> m_guard;
    GuardResult m_guarded;
    std::vector<Eigen::Vector3d> m_points;  // of the surface, predicted
    int m_contacts = 0, m_contactsWithRigid = 0;
    Eigen::Vector3d m_impulse = Eigen::Vector3d::Zero();
};

}  // namespace grapeshot::soft
