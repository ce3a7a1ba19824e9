// Bullet's own soft solver, but for bodies that are the surface of a CarriedBody: those are left to that.
#pragma once

#include <BulletSoftBody/btDefaultSoftBodySolver.h>

#include <functional>
#include <vector>

#include <grapeshot/plugin/soft_contacts.hpp>

#include "carried_body.hpp"

class btCollisionDispatcher;

namespace grapeshot::soft {

class CarriedSolver : public btDefaultSoftBodySolver {
  public:
    /// @param dispatcher that knows the contacts
    explicit CarriedSolver(const btCollisionDispatcher& dispatcher) : m_dispatcher(dispatcher) {}

    /// It must stay while the world steps.
    void add(CarriedBody& body) { m_carried.push_back(&body); }
    /// Rigid meshes that the surfaces must not pass through in the next step.
    std::vector<Obstacle> obstacles;
    void predictMotion(btScalar seconds) override;
    void solveConstraints(btScalar seconds) override;
    void updateSoftBodies() override;
    /// Called with a carried surface as it was predicted, and its contacts; may be empty.
    std::function<void(const btSoftBody&, const std::vector<SoftContact>&)> whenFound;

  private:
    CarriedBody* carriedOf(const btSoftBody* surface) const;

    const btCollisionDispatcher& m_dispatcher;
    std::vector<CarriedBody*> m_carried;
};

}  // namespace grapeshot::soft
