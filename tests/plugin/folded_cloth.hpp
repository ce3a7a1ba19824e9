// Cloth that has to keep off itself or another, and what became of it.
#pragma once

#include <algorithm>

#include "soft_fixture.hpp"

namespace grapeshot::test {

inline constexpr int foldSide = 17;  ///< nodes along an edge of the folded cloth

/// A sheet of 1.6 m whose right half lies 25 cm above its left one, over the ground.
inline btSoftBody* foldedCloth(btSoftBodyWorldInfo& info) {
    btSoftBody* body = btSoftBodyHelpers::CreatePatch(info, {-0.8_s, 0, -0.8_s}, {0.8_s, 0, -0.8_s}, {-0.8_s, 0, 0.8_s},
                                                      {0.8_s, 0, 0.8_s}, foldSide, foldSide, 0, true);
    for (int i = 0; i < body->m_nodes.size(); ++i) {
        btSoftBody::Node& node = body->m_nodes[i];
        const btScalar x = node.m_x.x();
        node.m_x.setX(x > 0.05_s ? -x : x);
        node.m_x.setY(x > 0.05_s ? 0.3_s : x > -0.05_s ? 0.15_s : 0.05_s);
        node.m_q = node.m_x;
    }
    body->setTotalMass(1);
    body->m_cfg.kDF = 0.5_s;
    body->m_cfg.piterations = 5;
    return body;
}

/// Nodes of the upper half below the lower one: straight down from it.
inline int nodesBelowOwnSheet(const btSoftBody& body) {
    const auto column = [&](const btSoftBody::Node* node) {
        return static_cast<int>(node - &body.m_nodes[0]) % foldSide;
    };
    int below = 0;
    for (int i = 0; i < body.m_nodes.size(); ++i) {
        const btVector3& x = body.m_nodes[i].m_x;
        double height = -1e9;
        for (int f = 0; f < body.m_faces.size() && i % foldSide > foldSide / 2; ++f) {
            const auto& corners = body.m_faces[f].m_n;
            if (std::max({column(corners[0]), column(corners[1]), column(corners[2])}) >= foldSide / 2) {
                continue;
            }
            const btVector3 u = corners[1]->m_x - corners[0]->m_x;
            const btVector3 v = corners[2]->m_x - corners[0]->m_x;
            const btVector3 w = x - corners[0]->m_x;
            const btScalar det = u.x() * v.z() - v.x() * u.z();
            const btScalar s = (w.x() * v.z() - v.x() * w.z()) / det;
            const btScalar t = (u.x() * w.z() - w.x() * u.z()) / det;
            if (det != 0 && s >= 0 && t >= 0 && s + t <= 1) {
                height = std::max(height, static_cast<double>(corners[0]->m_x.y() + s * u.y() + t * v.y()));
            }
        }
        below += static_cast<double>(x.y()) < height ? 1 : 0;
    }
    return below;
}

inline double meanHeight(const btSoftBody& body) {
    double sum = 0;
    for (int i = 0; i < body.m_nodes.size(); ++i) {
        sum += static_cast<double>(body.m_nodes[i].m_x.y());
    }
    return sum / body.m_nodes.size();
}

}  // namespace grapeshot::test
