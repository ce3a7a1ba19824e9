// Rigid meshes shot at cloth and at a soft solid, and past them, at 1 to 30 m/s.
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <grapeshot/core/random.hpp>

#include "soft_fixture.hpp"
#include "support/soft_shot.hpp"
#include "support/test_size.hpp"

namespace grapeshot::test {
namespace {

/// A square of 2 m in the xz plane at y = 0, held at its border, nodes 14 cm apart.
btSoftBody* heldSheet(btSoftBodyWorldInfo& info) {
    constexpr int nodes = 15;
    btSoftBody* sheet = cloth(info, {0, 0, 0}, 1, nodes, 0, 5);
    for (int k = 0; k < nodes; ++k) {
        for (const int border : {k, (nodes - 1) * nodes + k, nodes * k, nodes * k + nodes - 1}) {
            sheet->setMass(border, 0);
        }
    }
    return sheet;
}

/// 1.2 m x 0.4 m x 1.2 m of tetrahedra, its top at y = 0, held at its ground: cells of 20 cm, six tetrahedra each.
btSoftBody* heldBlock(btSoftBodyWorldInfo& info) {
    constexpr std::array<int, 3> nodes{7, 3, 7};
    constexpr btScalar cell = 0.2_s;
    const auto at = [&](int i, int j, int k) { return (k * nodes[1] + j) * nodes[0] + i; };
    std::vector<btVector3> places;
    for (int k = 0; k < nodes[2]; ++k) {
        for (int j = 0; j < nodes[1]; ++j) {
            for (int i = 0; i < nodes[0]; ++i) {
                places.push_back(cell * btVector3(btScalar(i - 3), btScalar(j - 2), btScalar(k - 3)));
            }
        }
    }
    auto* block = new btSoftBody(&info, static_cast<int>(places.size()), places.data(), nullptr);
    std::map<std::array<int, 3>, std::array<int, 3>> surface;  // faces that only one tetrahedron has
    for (int c = 0; c < 6 * 2 * 6; ++c) {
        std::array<int, 8> corner{};
        for (int q = 0; q < 8; ++q) {
            corner[static_cast<std::size_t>(q)] = at(c % 6 + (q & 1), c / 6 % 2 + (q >> 1 & 1), c / 12 + (q >> 2));
        }
        for (const auto& t : {std::array{0, 1, 3, 7}, std::array{0, 3, 2, 7}, std::array{0, 2, 6, 7},
                              std::array{0, 6, 4, 7}, std::array{0, 4, 5, 7}, std::array{0, 5, 1, 7}}) {
            std::array<int, 4> v{};
            std::ranges::transform(t, v.begin(), [&](int q) { return corner[static_cast<std::size_t>(q)]; });
            block->appendTetra(v[0], v[1], v[2], v[3]);
            for (std::size_t i = 0; i < 4; ++i) {
                std::array<int, 3> face{v[(i + 1) % 4], v[(i + 2) % 4], v[(i + 3) % 4]};
                std::array<int, 3> key = face;
                std::ranges::sort(key);
                if (!surface.emplace(key, face).second) {
                    surface.erase(key);
                }
                for (std::size_t k = 0; k < i; ++k) {
                    block->appendLink(v[i], v[k], nullptr, true);
                }
            }
        }
    }
    for (const auto& [key, face] : surface) {
        block->appendFace(face[0], face[1], face[2]);
    }
    block->setTotalMass(10);
    for (int i = 0; i < nodes[0]; ++i) {
        for (int k = 0; k < nodes[2]; ++k) {
            block->setMass(at(i, 0, k), 0);
        }
    }
    return block;
}

struct SoftShots {
    int through = 0;     ///< more than half of the body's corners are behind the surface in the end
    double fastest = 0;  ///< speed in the end / when shot
};

/// @param solid at the block, not at the sheet
SoftShots shootAtSoft(const scenes::Mesh& mesh, bool solid, int shots) {
    const MeshShape shape(mesh, Kind::mesh, 0.005_s);
    SoftShots result;
    for (int i = 0; i < shots; ++i) {
        const SoftShot shot = softShot(3, static_cast<std::uint64_t>(i));
        SoftTestWorld world;
        world.setGravity({0, 0, 0});
        btSoftBodyWorldInfo& info = world.world.getWorldInfo();
        btSoftBody& soft = world.add(solid ? heldBlock(info) : heldSheet(info), 0.02_s);
        soft.m_cfg.piterations = 4;
        btRigidBody& body = world.add(*shape, shot.from, 1);
        body.setLinearVelocity(shot.velocity);
        world.step(shot.steps);
        std::size_t behind = 0;
        for (const Eigen::Vector3f& v : mesh.vertices) {
            const btVector3 corner = body.getWorldTransform() * btVector3(v.x(), v.y(), v.z());
            behind += facesAbove(soft, corner) % 2 == 1 || (solid && corner.y() < -0.4_s) ? 1 : 0;
        }
        result.through += 2 * behind > mesh.vertices.size() ? 1 : 0;
        result.fastest = std::max(result.fastest, static_cast<double>(body.getLinearVelocity().length() / shot.speed));
        EXPECT_TRUE(isFinite(soft));
    }
    return result;
}

class SoftShotsAt : public testing::TestWithParam<bool> {};

TEST_P(SoftShotsAt, HardlyAnyGoesThrough) {
    const int shots = sampleSize(6, 500);
    const std::array meshes{std::pair("box", scenes::box({0.15F, 0.15F, 0.15F}, 2)),
                            std::pair("plate", scenes::box({0.01F, 0.2F, 0.2F}, 2)),
                            std::pair("spikedBall", scenes::spikedBall(0.12F, 0.1F, 12, 800)),
                            std::pair("torus", scenes::torus(0.15F, 0.05F, 24, 12))};
    for (const auto& [name, mesh] : meshes) {
        const SoftShots result = shootAtSoft(mesh, GetParam(), shots);
        RecordProperty(name, result.through);
        // A torus may be left hanging in a sheet that is drawn through it.
        const bool none = !GetParam() && name != std::string("torus");
        EXPECT_LE(result.through, none ? 0 : shots / 100) << name;
        EXPECT_LT(result.fastest, 1.2) << name;
    }
}

TEST_P(SoftShotsAt, WhatPassesByIsNotDisturbed) {
    // 1 cm and both margins past the border.
    const bool solid = GetParam();
    const btScalar place = (solid ? 0.6_s : 1.0_s) + 0.185_s;
    const MeshShape box(scenes::box({0.15F, 0.15F, 0.15F}, 2), Kind::mesh, 0.005_s);
    const int shots = sampleSize(10, 500);
    for (int i = 0; i < shots; ++i) {
        const RandomKey key{4, static_cast<std::uint64_t>(i), 0};
        const btScalar speed = 1 + 29 * btScalar(randomUnit(key, 0));
        SoftTestWorld world;
        world.setGravity({0, 0, 0});
        btSoftBodyWorldInfo& info = world.world.getWorldInfo();
        btSoftBody& soft = world.add(solid ? heldBlock(info) : heldSheet(info), 0.02_s);
        btRigidBody& body =
            world.add(*box, at({place, 1 + btScalar(randomUnit(key, 1)), 0.6_s * btScalar(randomUnit(key, 2))}), 1);
        body.setLinearVelocity({0, -speed, 0});
        world.step(static_cast<int>(180 / speed));
        EXPECT_EQ(body.getLinearVelocity().y(), -speed);
        EXPECT_EQ(body.getLinearVelocity().x(), 0);
        EXPECT_LT(fastest(soft), 1e-5) << speed;
    }
}

INSTANTIATE_TEST_SUITE_P(Soft, SoftShotsAt, testing::Bool(),
                         [](const auto& info) { return std::string(info.param ? "Solid" : "Cloth"); });

TEST(SoftShots, WhatFliesWithItsClothIsNotSlowed) {
    // A falling ball, a sheet just below it that falls as fast: it does not brake at what makes way.
    const MeshShape ball(scenes::sphere(0.2F, 4), Kind::mesh, 0.005_s);
    SoftTestWorld world;
    world.setGravity({0, 0, 0});
    btSoftBody& sheet = world.add(cloth(world.world.getWorldInfo(), {0, -0.24_s, 0}, 0.5_s, 9, 0, 1), 0.02_s);
    btRigidBody& body = world.add(*ball, at({0, 0, 0}), 1);
    body.setLinearVelocity({0, -20, 0});
    sheet.addVelocity({0, -20, 0});
    world.step(30);
    EXPECT_NEAR(body.getLinearVelocity().y(), -20, 0.5);
}

}  // namespace
}  // namespace grapeshot::test
