#include "carried_solver.hpp"

#include <algorithm>

namespace grapeshot::soft {

using Eigen::Vector3d;

namespace {

SurfaceContact contactOf(const SoftContact& told, const btSoftBody& surface) {
    SurfaceContact contact;
    contact.a = told.nodes;
    contact.weightsA = told.weights;
    contact.normal = told.normal.cast<double>();
    contact.before = static_cast<double>(told.distance);
    contact.rigid = told.other != &surface;
    if (!contact.rigid) {
        contact.b = told.otherNodes;
        contact.weightsB = told.otherWeights;
        return contact;
    }
    for (std::size_t i = 0; i < 3; ++i) {
        if (told.nodes[i] >= 0) {
            const btVector3& x = surface.m_nodes[told.nodes[i]].m_x;
            contact.offset += static_cast<double>(told.weights[i]) *
                              contact.normal.dot(Vector3d(static_cast<double>(x.x()), static_cast<double>(x.y()),
                                                          static_cast<double>(x.z())));
        }
    }
    contact.offset -= static_cast<double>(told.predicted);
    return contact;
}

}  // namespace

CarriedBody* CarriedSolver::carriedOf(const btSoftBody* surface) const {
    const auto at = std::find_if(m_carried.begin(), m_carried.end(),
                                 [surface](CarriedBody* carried) { return &carried->surface() == surface; });
    return at == m_carried.end() ? nullptr : *at;
}

void CarriedSolver::predictMotion(btScalar seconds) {
    for (int i = 0; i < m_softBodySet.size(); ++i) {
        if (CarriedBody* carried = carriedOf(m_softBodySet[i])) {
            carried->predict(seconds);
        } else if (m_softBodySet[i]->isActive()) {
            m_softBodySet[i]->predictMotion(seconds);
        }
    }
}

void CarriedSolver::solveConstraints(btScalar seconds) {
    for (int i = 0; i < m_softBodySet.size(); ++i) {
        btSoftBody& body = *m_softBodySet[i];
        if (CarriedBody* carried = carriedOf(&body)) {
            std::vector<SurfaceContact> contacts;
            const std::vector<SoftContact> known = contactsOf(&m_dispatcher, &body);
            if (whenFound) {
                whenFound(body, known);
            }
            for (const SoftContact& told : known) {
                contacts.push_back(contactOf(told, body));
            }
            carried->solve(contacts, obstacles, seconds);
        } else if (body.isActive()) {
            body.solveConstraints();
        }
    }
}

void CarriedSolver::updateSoftBodies() {
    for (int i = 0; i < m_softBodySet.size(); ++i) {
        if (m_softBodySet[i]->isActive() && carriedOf(m_softBodySet[i]) == nullptr) {
            m_softBodySet[i]->integrateMotion();
        }
    }
}

}  // namespace grapeshot::soft
