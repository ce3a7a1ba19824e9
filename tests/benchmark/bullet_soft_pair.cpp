#include "bullet_soft_pair.hpp"

#include <BulletSoftBody/btSoftBody.h>

#include <algorithm>
#include <array>
#include <vector>

namespace grapeshot::bench {

namespace {

/// Bullet takes triangles of less than 2e-4 square units for points, so it gets centimetres.
constexpr float unitsPerMetre = 100;

btVector3 scaled(const Eigen::Vector3f& p) {
    const Eigen::Vector3f there = unitsPerMetre * p;
    return {there.x(), there.y(), there.z()};
}

using Neighbours = std::vector<std::vector<int>>;

/// Whose children are neighbours, are.
Neighbours neighboursOfParents(const Neighbours& neighbours, const std::vector<int>& parent, int parents) {
    Neighbours result(static_cast<std::size_t>(parents));
    for (std::size_t i = 0; i < neighbours.size(); ++i) {
        for (const int other : neighbours[i]) {
            const int theirs = parent[static_cast<std::size_t>(other)];
            if (theirs != parent[i]) {
                result[static_cast<std::size_t>(parent[i])].push_back(theirs);
            }
        }
    }
    for (std::vector<int>& list : result) {
        std::ranges::sort(list);
        list.erase(std::unique(list.begin(), list.end()), list.end());
    }
    return result;
}

btDbvtNode* newNode() {
    auto* node = new (btAlignedAlloc(sizeof(btDbvtNode), 16)) btDbvtNode();
    node->parent = nullptr;
    node->childs[0] = node->childs[1] = nullptr;
    return node;
}

/// As Bullet's buildTreeBottomUp: each with the first of its neighbours that is free, level by level.
btDbvtNode* pairedUp(std::vector<btDbvtNode*> nodes, Neighbours neighbours) {
    while (nodes.size() > 1) {
        std::vector<btDbvtNode*> above;
        std::vector<int> parent(nodes.size(), -1);
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            if (parent[i] >= 0) {
                continue;
            }
            parent[i] = static_cast<int>(above.size());
            const auto other =
                std::ranges::find_if(neighbours[i], [&](int n) { return parent[static_cast<std::size_t>(n)] < 0; });
            if (other == neighbours[i].end()) {
                above.push_back(nodes[i]);
                continue;
            }
            const auto n = static_cast<std::size_t>(*other);
            parent[n] = parent[i];
            btDbvtNode* both = newNode();
            both->childs[0] = nodes[i];
            both->childs[1] = nodes[n];
            nodes[i]->parent = nodes[n]->parent = both;
            above.push_back(both);
        }
        neighbours = neighboursOfParents(neighbours, parent, static_cast<int>(above.size()));
        nodes = std::move(above);
    }
    return nodes.front();
}

template <class Parts>
btDbvtNode* treeOf(Parts& parts, Neighbours neighbours) {
    std::vector<btDbvtNode*> leaves;
    for (int i = 0; i < parts.size(); ++i) {
        parts[i].m_leaf = newNode();
        parts[i].m_leaf->data = &parts[i];
        leaves.push_back(parts[i].m_leaf);
    }
    return pairedUp(std::move(leaves), std::move(neighbours));
}

Neighbours facesAcross(const scenes::Mesh& mesh) {
    std::vector<std::array<std::uint32_t, 3>> sides;  // lower corner, higher corner, face
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        for (std::size_t i = 0; i < 3; ++i) {
            const auto [low, high] = std::minmax(mesh.triangles[t][i], mesh.triangles[t][(i + 1) % 3]);
            sides.push_back({low, high, static_cast<std::uint32_t>(t)});
        }
    }
    std::ranges::sort(sides);
    Neighbours faces(mesh.triangles.size());
    for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
        if (sides[i][0] == sides[i + 1][0] && sides[i][1] == sides[i + 1][1]) {
            faces[sides[i][2]].push_back(static_cast<int>(sides[i + 1][2]));
            faces[sides[i + 1][2]].push_back(static_cast<int>(sides[i][2]));
        }
    }
    for (std::vector<int>& list : faces) {
        std::ranges::sort(list);
    }
    return faces;
}

void buildTrees(const scenes::Mesh& mesh, btSoftBody& body) {
    Neighbours faces = facesAcross(mesh);
    body.m_fdbvt.m_root = treeOf(body.m_faces, std::move(faces));
    Neighbours nodes(mesh.vertices.size());
    for (int i = 0; i < body.m_links.size(); ++i) {
        const auto from = static_cast<int>(body.m_links[i].m_n[0] - &body.m_nodes[0]);
        const auto to = static_cast<int>(body.m_links[i].m_n[1] - &body.m_nodes[0]);
        nodes[static_cast<std::size_t>(from)].push_back(to);
        nodes[static_cast<std::size_t>(to)].push_back(from);
    }
    body.m_ndbvt.clear();
    body.m_ndbvt.m_root = treeOf(body.m_nodes, std::move(nodes));
}

std::unique_ptr<btSoftBody> softBody(btSoftBodyWorldInfo& info, const scenes::Mesh& mesh, float margin,
                                     BulletSoftPair::Trees trees) {
    std::vector<btVector3> nodes;
    for (const Eigen::Vector3f& v : mesh.vertices) {
        nodes.push_back(scaled(v));
    }
    auto body = std::make_unique<btSoftBody>(&info, static_cast<int>(nodes.size()), nodes.data(), nullptr);
    for (const Triangle& t : mesh.triangles) {
        const std::array corners{static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2])};
        body->appendFace(corners[0], corners[1], corners[2]);
        for (std::size_t i = 0; i < 3; ++i) {
            if (corners[i] < corners[(i + 1) % 3]) {  // of a closed mesh, each edge once: what Bullet's trees go by
                body->appendLink(corners[i], corners[(i + 1) % 3]);
            }
        }
    }
    body->m_cfg.collisions |= btSoftBody::fCollision::VF_SS;
    body->getCollisionShape()->setMargin(btScalar(unitsPerMetre * margin));
    body->m_sst.radmrg = btScalar(unitsPerMetre * margin);
    if (trees == BulletSoftPair::Trees::byBullet) {
        body->initializeFaceTree();
        delete body->m_fdbvnt;  // of VF_DD alone; it would be brought up to date too
        body->m_fdbvnt = nullptr;
    } else {
        buildTrees(mesh, *body);
    }
    return body;
}

void placeNodes(std::span<const Eigen::Vector3f> positions, btSoftBody& body) {
    for (int i = 0; i < body.m_nodes.size(); ++i) {
        btSoftBody::Node& node = body.m_nodes[i];
        node.m_x = scaled(positions[static_cast<std::size_t>(i)]);
        node.m_q = node.m_x;  // else what it has moved counts for its margin
        node.m_v.setZero();
    }
}

}  // namespace

struct BulletSoftPair::State {
    btSoftBodyWorldInfo info;
    std::unique_ptr<btSoftBody> a, b;
};

BulletSoftPair::BulletSoftPair(const scenes::Mesh& a, const scenes::Mesh& b, float distance, Trees trees)
    : m_state(std::make_unique<State>()) {
    m_state->a = softBody(m_state->info, a, 0.5F * distance, trees);
    m_state->b = softBody(m_state->info, b, 0.5F * distance, trees);
}

BulletSoftPair::~BulletSoftPair() = default;

void BulletSoftPair::place(std::span<const Eigen::Vector3f> a, std::span<const Eigen::Vector3f> b) {
    placeNodes(a, *m_state->a);
    placeNodes(b, *m_state->b);
}

void BulletSoftPair::updateTrees() {
    for (btSoftBody* body : {m_state->a.get(), m_state->b.get()}) {
        body->updateNodeTree(false, true);
        body->updateFaceTree(false, true);
    }
}

std::size_t BulletSoftPair::collide() {
    m_state->a->m_scontacts.resize(0);
    m_state->b->m_scontacts.resize(0);
    m_state->a->defaultCollisionHandler(m_state->b.get());
    return static_cast<std::size_t>(m_state->a->m_scontacts.size() + m_state->b->m_scontacts.size());
}

}  // namespace grapeshot::bench
