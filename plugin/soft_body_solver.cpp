#include <grapeshot/plugin/soft_body_solver.hpp>

#include <BulletSoftBody/btSoftBody.h>

#include <grapeshot/plugin/detail/context.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {

bool SoftBodySolver::isOurs() const {
    const auto context = detail::Contexts::instance().find(m_dispatcher);
    return context != nullptr && context->settings.softPairs;
}

void SoftBodySolver::predictMotion(btScalar seconds) {
    if (!isOurs()) {
        btDefaultSoftBodySolver::predictMotion(seconds);
        return;
    }
    for (int i = 0; i < m_softBodySet.size(); ++i) {
        if (m_softBodySet[i]->isActive()) {
            predict(*m_softBodySet[i], seconds);
        }
    }
}

void SoftBodySolver::predict(btSoftBody& body, btScalar seconds) {
    if (body.m_bUpdateRtCst) {
        body.m_bUpdateRtCst = false;
        body.updateConstants();
    }
    body.m_fdbvt.clear();
    btSoftBody::SolverState& state = body.m_sst;
    state.sdt = seconds * body.m_cfg.timescale;
    state.isdt = 1 / state.sdt;
    state.velmrg = 3 * state.sdt;
    state.radmrg = body.getCollisionShape()->getMargin();
    state.updmrg = state.radmrg / 4;
    body.addVelocity(body.m_worldInfo->m_gravity * state.sdt);
    body.applyForces();
    const btScalar fastest = body.m_worldInfo->m_maxDisplacement / state.sdt;
    const btVector3 most(fastest, fastest, fastest);
    for (int i = 0; i < body.m_nodes.size(); ++i) {
        btSoftBody::Node& node = body.m_nodes[i];
        btVector3 gained = node.m_f * (node.m_im * state.sdt);
        gained.setMin(most);
        gained.setMax(-most);
        node.m_v += gained;
        node.m_q = node.m_x;
        node.m_x += node.m_v * state.sdt;
        node.m_f.setZero();
    }
    body.updateClusters();
    body.updateBounds();
    updateNodeTree(body);
    body.updatePose();
    if (body.m_pose.m_bframe && body.m_cfg.kMT > 0) {
        for (int i = 0; i < body.m_nodes.size(); ++i) {
            btSoftBody::Node& node = body.m_nodes[i];
            if (node.m_im > 0) {
                const btVector3 wanted = body.m_pose.m_rot * body.m_pose.m_pos[i] + body.m_pose.m_com;
                node.m_x = lerp(node.m_x, wanted, body.m_cfg.kMT);
            }
        }
    }
    body.m_rcontacts.resizeNoInitialize(0);
    body.m_scontacts.resizeNoInitialize(0);
}

void SoftBodySolver::solveConstraints(btScalar seconds) {
    btDefaultSoftBodySolver::solveConstraints(seconds);
    if (m_contactsLast && isOurs()) {
        solveContactsOnceMore();
    }
}

void SoftBodySolver::solveContactsOnceMore() {
    // A contact of two bodies moves nodes of both.
    m_places.clear();
    for (int i = 0; i < m_softBodySet.size(); ++i) {
        for (int k = 0; k < m_softBodySet[i]->m_nodes.size(); ++k) {
            m_places.push_back(m_softBodySet[i]->m_nodes[k].m_x);
        }
    }
    // Rigid ones last: their surfaces do not give way.
    for (const auto solve : {&btSoftBody::PSolve_SContacts, &btSoftBody::PSolve_RContacts}) {
        for (int i = 0; i < m_softBodySet.size(); ++i) {
            if (m_softBodySet[i]->isActive() && m_softBodySet[i]->m_cfg.piterations > 0) {
                solve(m_softBodySet[i], 1, 1);
            }
        }
    }
    auto before = m_places.begin();
    for (int i = 0; i < m_softBodySet.size(); ++i) {
        btSoftBody& body = *m_softBodySet[i];
        const btScalar perSecond = body.m_sst.isdt * (1 - body.m_cfg.kDP);
        for (int k = 0; k < body.m_nodes.size(); ++k, ++before) {
            const btVector3 moved = body.m_nodes[k].m_x - *before;
            if (!moved.isZero()) {
                body.m_nodes[k].m_v += moved * perSecond;
            }
        }
    }
}

void SoftBodySolver::updateNodeTree(btSoftBody& body) {
    const btSoftBody::SolverState& state = body.m_sst;
    bool changed = false;
    for (int i = 0; i < body.m_nodes.size(); ++i) {
        const btSoftBody::Node& node = body.m_nodes[i];
        btDbvtVolume volume = btDbvtVolume::FromCR(node.m_x, state.radmrg);
        if (!node.m_leaf->volume.Contain(volume)) {
            // As Bullet makes them: good for some steps.
            volume.Expand({state.updmrg, state.updmrg, state.updmrg});
            volume.SignedExpand(node.m_v * state.velmrg);
            node.m_leaf->volume = volume;
            changed = true;
        }
    }
    if (!changed || body.m_ndbvt.m_root == nullptr) {
        return;
    }
    m_inner.clear();
    if (body.m_ndbvt.m_root->isinternal()) {
        m_inner.push_back(body.m_ndbvt.m_root);
    }
    for (std::size_t i = 0; i < m_inner.size(); ++i) {
        for (btDbvtNode* child : m_inner[i]->childs) {
            if (child->isinternal()) {
                m_inner.push_back(child);
            }
        }
    }
    for (auto node = m_inner.rbegin(); node != m_inner.rend(); ++node) {
        Merge((*node)->childs[0]->volume, (*node)->childs[1]->volume, (*node)->volume);
    }
}

}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
