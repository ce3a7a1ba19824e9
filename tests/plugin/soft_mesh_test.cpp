// Cloth, ropes and soft solids against rigid meshes in btSoftRigidDynamicsWorld.
#include <gmock/gmock.h>

#include <cmath>

#include "soft_fixture.hpp"
#include "support/test_size.hpp"

namespace grapeshot::test {
namespace {

struct SoftRest {
    int inside = 0;  ///< nodes, over the last second
    double lowest = 0, highest = 0;
    bool finite = true;
    int contacts = 0;
};

/// A square of cloth falls on a torus mesh and stays there. Lengths are multiples of `scale`; the surface of the mesh
/// is a polygon in the torus, at most 1 % of the tube inside.
SoftRest restOnTorus(double scale, Kind kind, double seconds, int substeps) {
    const auto ring = static_cast<float>(scale);
    const MeshShape torus(scenes::torus(ring, 0.3F * ring, 48, 24), kind, btScalar(0.005 * scale));
    SoftTestWorld world;
    world.add(*torus, at({0, 0, 0})).setFriction(1);
    btSoftBody& sheet =
        world.add(cloth(world.world.getWorldInfo(), {0, btScalar(0.6 * scale), 0}, btScalar(1.3 * scale), 21, 0, 1),
                  btScalar(0.04 * scale));
    sheet.m_cfg.kDF = 1;
    sheet.m_cfg.piterations = 5;
    SoftRest rest;
    const int frames = static_cast<int>(seconds * 60);
    for (int i = 0; i < frames; ++i) {
        world.step(substeps, 1.0_s / btScalar(60 * substeps));
        rest.inside += i >= frames - 60 ? nodesInTorus(sheet, scale, 0.3 * scale, 0.01 * 0.3 * scale) : 0;
    }
    rest.finite = isFinite(sheet);
    rest.contacts = sheet.m_rcontacts.size();
    rest.lowest = 1e9;
    rest.highest = -1e9;
    for (int i = 0; i < sheet.m_nodes.size(); ++i) {
        const double y = static_cast<double>(sheet.m_nodes[i].m_x.y()) / scale;
        rest.lowest = std::min(rest.lowest, y);
        rest.highest = std::max(rest.highest, y);
    }
    return rest;
}

void expectRest(const SoftRest& rest) {
    EXPECT_TRUE(rest.finite);
    EXPECT_EQ(rest.inside, 0);
    EXPECT_GT(rest.contacts, 10);
    EXPECT_GT(rest.highest, 0.3);
    EXPECT_LT(rest.highest, 0.4);
    EXPECT_GT(rest.lowest, -1);
}

TEST(SoftMesh, ClothRestsOnATorusOfAMetre) {
    expectRest(restOnTorus(1, Kind::mesh, sampleSize(6, 20), 1));
}

TEST(SoftMesh, ClothRestsOnATorusOfADecimetre) {
    // In a step of 1/60 s gravity alone moves a node by a tenth of the tube, and Bullet's links let it pass on.
    expectRest(restOnTorus(0.1, Kind::bvh, sampleSize(4, 20), 4));
}

}  // namespace
}  // namespace grapeshot::test
