// Height fields as meshes: the triangles and names that Bullet gives them, edits, bodies on hills.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include <BulletCollision/CollisionShapes/btHeightfieldTerrainShape.h>
#include <grapeshot/plugin/detail/shape_mesh.hpp>

#include "bullet_fixture.hpp"

namespace grapeshot::test {
namespace {

constexpr int columns = 6;
constexpr int rows = 4;

std::vector<float> bumps(int count) {
    std::vector<float> heights;
    for (int i = 0; i < count; ++i) {
        heights.push_back(0.3F * std::sin(1.7F * static_cast<float>(i * i % 11)));
    }
    return heights;
}

struct NamedTriangle {
    std::array<btVector3, 3> corner;
    int part = 0, index = 0;
};

/// As Bullet lists them.
struct Listed : btTriangleCallback {
    void processTriangle(btVector3* triangle, int part, int index) override {
        triangles.push_back({{triangle[0], triangle[1], triangle[2]}, part, index});
    }
    std::vector<NamedTriangle> triangles;
};

bool sameCorners(const std::array<btVector3, 3>& x, const std::array<btVector3, 3>& y) {
    return std::ranges::all_of(x, [&](const btVector3& corner) {
        return std::ranges::any_of(y, [&](const btVector3& other) { return corner.distance(other) < 1e-5; });
    });
}

// Up axis, other diagonal, diamonds, zigzag, mirrored.
class Fields : public testing::TestWithParam<std::tuple<int, bool, bool, bool, bool>> {};

TEST_P(Fields, HaveBulletsTrianglesAndNamesAndTheirOutsideIsUp) {
    const auto [up, flipped, diamonds, zigzag, mirrored] = GetParam();
    const std::vector<float> heights = bumps(columns * rows);
    btHeightfieldTerrainShape shape(columns, rows, heights.data(), -1.0_s, 1.0_s, up, flipped);
    shape.setUseDiamondSubdivision(diamonds);
    shape.setUseZigzagSubdivision(zigzag);
    btVector3 scale(0.5_s, 0.7_s, 1.5_s);
    scale[(up + 1) % 3] *= mirrored ? -1 : 1;
    shape.setLocalScaling(scale);
    Listed listed;
    const btVector3 everywhere(1e5_s, 1e5_s, 1e5_s);
    if (!mirrored) {  // its box would be inside out to Bullet
        shape.processAllTriangles(&listed, -everywhere, everywhere);
    }
    std::vector<detail::PartSource> sources;
    detail::sourcesOf(shape, sources);
    const detail::ShapeMesh mesh = detail::readMesh(sources);
    ASSERT_EQ(mesh.triangles.size(), 2U * (columns - 1) * (rows - 1));
    std::size_t found = 0;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        NamedTriangle ours;
        for (std::size_t i = 0; i < 3; ++i) {
            const Eigen::Vector3f& v = mesh.vertices[mesh.triangles[t][i]];
            ours.corner[i] = {v.x(), v.y(), v.z()};
        }
        const btVector3 outward = (ours.corner[1] - ours.corner[0]).cross(ours.corner[2] - ours.corner[0]);
        EXPECT_GT(outward[up], 0) << t;
        const detail::TriangleId id = detail::idOf(mesh.parts, t);
        found += std::ranges::count_if(listed.triangles, [&](const NamedTriangle& theirs) {
            return theirs.part == id.part && theirs.index == id.index && sameCorners(theirs.corner, ours.corner);
        });
    }
    EXPECT_EQ(found, listed.triangles.size());
    EXPECT_EQ(listed.triangles.size(), mirrored ? 0 : mesh.triangles.size());
}

INSTANTIATE_TEST_SUITE_P(All, Fields,
                         testing::Combine(testing::Range(0, 3), testing::Bool(), testing::Bool(), testing::Bool(),
                                          testing::Bool()));

TEST(HeightField, BodiesOfEveryKindRestOnHills) {
    constexpr int side = 21;
    std::vector<float> heights;
    for (int i = 0; i < side * side; ++i) {
        const float x = static_cast<float>(i % side - side / 2) / 10;
        const float z = static_cast<float>(i / side - side / 2) / 10;
        heights.push_back(0.5F * (x * x + z * z));  // a bowl: whatever falls stays near the middle
    }
    btHeightfieldTerrainShape bowl(side, side, heights.data(), 0.0_s, 2.0_s, 1, false);
    bowl.setLocalScaling({0.2_s, 1, 0.2_s});
    for (const Kind kind : allKinds) {
        const MeshShape block(scenes::crenelBlock({0.3F, 0.2F, 0.25F}, 3), kind, 0.01_s);
        TestWorld world;
        world.add(bowl, at({0, 0, 0}));
        btRigidBody& body = world.add(*block, at({0.3_s, 0.5_s, 0.2_s}, btQuaternion({0, 0, 1}, 0.4_s)), 1);
        body.setActivationState(DISABLE_DEACTIVATION);
        world.step(360);
        // The bowl's bottom is at -1: the box of a field is about its middle.
        EXPECT_NEAR(body.getWorldTransform().getOrigin().y(), -0.75, 0.1) << body.getCollisionShape()->getName();
        EXPECT_LT(body.getLinearVelocity().length(), 0.03);
        EXPECT_LT(world.stats().deepest, 0.02F);
        EXPECT_EQ(world.stats().fallbacks, 0U);
    }
}

TEST(HeightField, ABodyFollowsHeightsThatSink) {
    std::vector<float> heights(9 * 9, 0.5F);
    btHeightfieldTerrainShape field(9, 9, heights.data(), -1.0_s, 1.0_s, 1, false);
    const MeshShape block(scenes::box({0.5F, 0.5F, 0.5F}, 2), Kind::mesh, 0.01_s);
    TestWorld world;
    world.add(field, at({0, 0, 0}));
    btRigidBody& body = world.add(*block, at({0, 1.02_s, 0}), 1);
    body.setActivationState(DISABLE_DEACTIVATION);
    world.step(30);
    EXPECT_NEAR(body.getWorldTransform().getOrigin().y(), 1.01, 0.01);
    std::fill(heights.begin(), heights.end(), 0.2F);
    notifyChanged(&field);
    world.step(90);
    EXPECT_NEAR(body.getWorldTransform().getOrigin().y(), 0.71, 0.01);
}

TEST(HeightField, HeightsThatAreNoNumbersAreRefused) {
    std::vector<float> heights(9, 0.0F);
    heights[4] = std::numeric_limits<float>::quiet_NaN();
    btHeightfieldTerrainShape field(3, 3, heights.data(), -1.0_s, 1.0_s, 1, false);
    const MeshShape block(scenes::box({0.5F, 0.5F, 0.5F}), Kind::mesh);
    TestWorld world;
    world.add(field, at({0, 0, 0}));
    world.add(*block, at({0, 0.4_s, 0}), 1);
    world.step();
    EXPECT_EQ(world.stats().refused, 1);
    EXPECT_THAT(world.stats().lastRefusal, testing::HasSubstr("vertex"));
    heights[4] = 0;
    notifyChanged(&field);
    world.step();
    EXPECT_EQ(world.stats().refused, 0);
    EXPECT_GT(world.stats().contacts, 0);
}

}  // namespace
}  // namespace grapeshot::test
