// Meshes that appear in mid-run: no frame waits for their trees, and something holds the bodies until they are there.
#include <grapeshot/plugin/detail/sampled_mesh.hpp>

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <filesystem>

#include "bullet_fixture.hpp"

namespace grapeshot::test {
namespace {

constexpr std::uint64_t budget = 3000;

Settings budgeted() {
    Settings settings;
    settings.frameBudget.work = budget;
    return settings;
}

/// Steps until the pair is looked at with the shape's own tree; the frames that took. Every one within its bound.
template <class World>
int stepsUntilBuilt(World& world, int most) {
    for (int i = 1; i <= most; ++i) {
        world.step();
        const StepStatistics& s = world.stats();
        EXPECT_LE(s.work, std::max(s.budget, s.mandatory)) << "step " << i;
        if (!s.pairs.empty() && s.degraded == 0) {
            return i;
        }
    }
    return most + 1;
}

TEST(SlicedShapes, AFloorThatAppearsHoldsABodyAtOnce) {
    const MeshShape ball(scenes::sphere(0.5F, 6), Kind::mesh, 0.02_s);
    // Not flat, and met nowhere else in this program.
    const MeshShape floor(scenes::grid(4, 4, 160, 161), Kind::bvh, 0.02_s);
    ASSERT_GT(floor.mesh.triangles.size(), 50000U);
    BudgetWorld world(budgeted());
    constexpr int count = 6;
    for (int i = 0; i < count; ++i) {
        const btScalar x = 1.3_s * btScalar(i % 3) - 1.4_s;
        world.add(*ball, at({x, 0.6_s, 1.5_s * btScalar(i / 3) - 0.7_s}), 1).setActivationState(DISABLE_DEACTIVATION);
    }
    const auto lowest = [&] {
        btScalar y = BT_LARGE_FLOAT;
        for (std::size_t i = 0; i < count; ++i) {
            y = btMin(y, world.bodies[i]->getWorldTransform().getOrigin().y());
        }
        return y;
    };
    world.step(2);
    world.add(*floor, at({0, 0, 0}));
    world.step();
    ASSERT_EQ(world.stats().degraded, count) << "a stand-in";
    EXPECT_FALSE(world.stats().pairs.front().certain);
    EXPECT_GT(world.stats().building, 1000U) << "the stand-in is paid for";
    EXPECT_GE(world.stats().work, world.stats().building);
    EXPECT_LT(world.stats().mandatory, 12000U) << "and bounded, whatever the mesh";
    const std::uint64_t wanted = 16 * floor.mesh.triangles.size();
    const int frames = stepsUntilBuilt(world, 2 * static_cast<int>(wanted / (budget / 4)));
    EXPECT_GT(frames, static_cast<int>(floor.mesh.triangles.size() / budget)) << "it was not built at once";
    EXPECT_LT(frames, static_cast<int>(wanted / (budget / 4)));
    EXPECT_GT(lowest(), 0.45) << "held all the while";
    world.step(30);
    EXPECT_NEAR(lowest(), 0.54, 0.02);
    EXPECT_EQ(world.stats().degraded, 0);
    for (const btManifoldPoint& point : world.points()) {
        EXPECT_GE(std::max(point.m_index0, point.m_index1), 0) << "contacts have triangles again";
    }
}

/// The ball tree takes twice as long as the rest; adb serves the pair meanwhile.
TEST(SlicedShapes, ByScfTheBallTreeIsBuiltInSlicesToo) {
    const MeshShape ball(scenes::sphere(0.5F, 6), Kind::mesh, 0.02_s);
    const MeshShape floor(scenes::grid(2, 2, 70, 71), Kind::bvh, 0.02_s);
    Settings settings = budgeted();
    settings.method = Method::scf;
    BudgetWorld world(settings);
    btRigidBody& body = world.add(*ball, at({0.3_s, 0.6_s, 0.2_s}), 1);
    body.setActivationState(DISABLE_DEACTIVATION);
    ASSERT_EQ(prebuild(ball.get(), Method::scf), Status::ok);
    world.step(2);
    world.add(*floor, at({0, 0, 0}));
    world.step();
    ASSERT_EQ(world.stats().degraded, 1) << "a stand-in";
    EXPECT_EQ(world.stats().leftToAdb, 1);
    EXPECT_EQ(world.stats().tracked, 0);
    const std::size_t triangles = floor.mesh.triangles.size();
    const int frames = stepsUntilBuilt(world, static_cast<int>(80 * triangles / (budget / 4)));
    EXPECT_GT(frames, static_cast<int>(20 * triangles / budget)) << "it was not built at once";
    EXPECT_LT(frames, static_cast<int>(80 * triangles / (budget / 4)));
    EXPECT_EQ(world.stats().leftToAdb, 0);
    EXPECT_EQ(world.stats().tracked, 1);
    EXPECT_GT(body.getWorldTransform().getOrigin().y(), 0.45);
}

TEST(SlicedShapes, AMovingMeshRestsOnItsSample) {
    const MeshShape floor(scenes::grid(3, 3, 8, 8), Kind::bvh, 0.02_s);
    const MeshShape ball(scenes::bumpySphere(0.5F, 0.05F, 3, 61), Kind::mesh, 0.02_s);
    ASSERT_GT(ball.mesh.triangles.size(), 70000U);
    Settings settings = budgeted();
    settings.frameBudget.work = 0;  // 64 units a frame: it will not be ready
    BudgetWorld world(settings);
    world.add(*floor, at({0, 0, 0}));
    btRigidBody& body = world.add(*ball, at({0, 0.7_s, 0}), 1, {0.1_s, 0.1_s, 0.1_s});
    body.setActivationState(DISABLE_DEACTIVATION);
    for (int i = 0; i < 300; ++i) {
        world.step();
        ASSERT_LE(world.stats().work, world.stats().mandatory);
        if (!world.stats().pairs.empty()) {
            ASSERT_EQ(world.stats().degraded, 1);
        }
    }
    EXPECT_GT(body.getWorldTransform().getOrigin().y(), 0.35);
    EXPECT_LT(body.getWorldTransform().getOrigin().y(), 0.7);
}

TEST(SlicedShapes, AnEditGoesOnWithWhatWasUntilItIsThere) {
    const MeshShape ball(scenes::sphere(0.5F, 6), Kind::mesh, 0.02_s);
    MeshShape floor(scenes::grid(2, 2, 96, 97), Kind::bvh, 0.02_s);
    BudgetWorld world(budgeted());
    world.add(*floor, at({0, 0, 0}));
    ASSERT_EQ(prebuild(floor.get()), Status::ok);
    btRigidBody& body = world.add(*ball, at({0.3_s, 0.55_s, 0.2_s}), 1);
    body.setActivationState(DISABLE_DEACTIVATION);
    world.step(60);
    ASSERT_EQ(world.stats().degraded, 0) << "built beforehand";
    const btScalar before = body.getWorldTransform().getOrigin().y();
    for (Eigen::Vector3f& vertex : floor.mesh.vertices) {
        vertex.y() -= 0.05F;
    }
    notifyChanged(floor.get());
    world.step();
    EXPECT_EQ(world.stats().degraded, 1);
    EXPECT_NEAR(body.getWorldTransform().getOrigin().y(), before, 0.005);
    EXPECT_GT(stepsUntilBuilt(world, 2000), 10);
    world.step(60);
    EXPECT_NEAR(body.getWorldTransform().getOrigin().y(), before - 0.05_s, 0.01);
}

TEST(SlicedShapes, WithoutABudgetAndInQueriesTreesAreBuiltAtOnce) {
    const MeshShape ball(scenes::sphere(0.5F, 6), Kind::mesh, 0.02_s);
    const MeshShape floor(scenes::grid(2, 2, 90, 91), Kind::bvh, 0.02_s);
    {
        BudgetWorld world(budgeted());
        btRigidBody& body = world.add(*ball, at({0.3_s, 0.5_s, 0.2_s}), 1);
        btRigidBody& ground = world.add(*floor, at({0, 0, 0}));
        world.step();
        ASSERT_EQ(world.stats().degraded, 1);
        Collector found;
        world.world.contactPairTest(&body, &ground, found);
        EXPECT_FALSE(found.points.empty());
        world.step();
        EXPECT_EQ(world.stats().degraded, 0) << "the query has finished the tree";
    }
    const MeshShape other(scenes::grid(2, 2, 90, 92), Kind::bvh, 0.02_s);
    BudgetWorld world;
    world.add(*ball, at({0.3_s, 0.5_s, 0.2_s}), 1);
    world.add(*other, at({0, 0, 0}));
    world.step();
    EXPECT_EQ(world.stats().degraded, 0);
}

TEST(SlicedShapes, AChildOfACompoundIsBuiltToo) {
    const MeshShape ball(scenes::sphere(0.5F, 6), Kind::mesh, 0.02_s);
    const MeshShape floor(scenes::grid(2, 2, 60, 61), Kind::bvh, 0.02_s);
    btCompoundShape compound;
    compound.addChildShape(at({0, 0, 0}), floor.get());
    BudgetWorld world(budgeted());
    btRigidBody& body = world.add(*ball, at({0.3_s, 0.55_s, 0.2_s}), 1);
    body.setActivationState(DISABLE_DEACTIVATION);
    world.add(compound, at({0, 0, 0}));
    EXPECT_GT(stepsUntilBuilt(world, 2000), 5);
    world.step(30);
    EXPECT_EQ(world.stats().degraded, 0);
    EXPECT_NEAR(body.getWorldTransform().getOrigin().y(), 0.54, 0.03);
}

TEST(SlicedShapes, AnUnusableMeshIsRefusedWhenThatIsFound) {
    const MeshShape ball(scenes::sphere(0.5F, 6), Kind::mesh, 0.02_s);
    MeshShape floor(scenes::grid(2, 2, 70, 71), Kind::bvh, 0.02_s);
    floor.mesh.vertices[5].y() = std::numeric_limits<float>::quiet_NaN();
    BudgetWorld world(budgeted());
    world.add(*ball, at({0.3_s, 0.5_s, 0.2_s}), 1);
    world.add(*floor, at({0, 0, 0}));
    world.step();
    EXPECT_EQ(world.stats().refused, 0);
    for (int i = 0; i < 400 && world.stats().refused == 0; ++i) {
        world.step();
    }
    EXPECT_EQ(world.stats().refused, 1);
    EXPECT_NE(world.stats().lastRefusal.find("vertex 5"), std::string::npos) << world.stats().lastRefusal;
}

TEST(SlicedShapes, AreTheSameOnAnyNumberOfThreads) {
    std::array<std::uint64_t, 3> hashes{};
    const MeshShape ball(scenes::sphere(0.5F, 6), Kind::mesh, 0.02_s);
    prebuild(ball.get());
    for (std::size_t k = 0; k < 3; ++k) {
        // Other coordinates each time, or the cache has it; the ball is far from the difference.
        scenes::Mesh ground = scenes::grid(2, 2, 50, 51);
        ground.vertices.front().x() -= 0.001F * static_cast<float>(k);
        const MeshShape floor(std::move(ground), Kind::bvh, 0.02_s);
        Settings settings = budgeted();
        settings.threads = 1 << k;
        BudgetWorld world(settings);
        world.add(*ball, at({0.3_s, 0.6_s, 0.2_s}), 1);
        world.add(*floor, at({0, 0, 0}));
        world.step();
        ASSERT_EQ(world.stats().degraded, 1) << "it is being built";
        world.step(200);
        ASSERT_EQ(world.stats().degraded, 0);
        hashes[k] = hashOf(world);
    }
    EXPECT_EQ(hashes[0], hashes[1]);
    EXPECT_EQ(hashes[0], hashes[2]);
}

TEST(SlicedShapes, ASampleCoversTheSurfaceWithinItsBox) {
    const scenes::Mesh mesh = scenes::sphere(1, 40);
    detail::PartSource source;
    source.vertexBase = reinterpret_cast<const unsigned char*>(mesh.vertices.data());
    source.vertices = static_cast<int>(mesh.vertices.size());
    source.vertexStride = sizeof(Eigen::Vector3f);
    source.indexBase = reinterpret_cast<const unsigned char*>(mesh.triangles.data());
    source.triangles = static_cast<int>(mesh.triangles.size());
    source.indexStride = sizeof(Triangle);
    const detail::ShapeMesh sample = detail::sampledMesh({&source, 1});
    EXPECT_LE(sample.triangles.size(), detail::sampledShapeTriangles);
    EXPECT_GT(sample.triangles.size(), detail::sampledShapeTriangles / 2);
    double area = 0;
    for (const Triangle& t : sample.triangles) {
        const Eigen::Vector3f u = sample.vertices[t[1]] - sample.vertices[t[0]];
        const Eigen::Vector3f v = sample.vertices[t[2]] - sample.vertices[t[0]];
        area += 0.5 * static_cast<double>(u.cross(v).norm());
        for (const std::uint32_t corner : t) {
            EXPECT_LE(sample.vertices[corner].cwiseAbs().maxCoeff(), 1.0001F);
            EXPECT_GT(sample.vertices[corner].norm(), 0.9F);
        }
    }
    EXPECT_GT(area, 2 * 4 * 3.14159) << "they overlap";
    source.triangles = 0;
    EXPECT_TRUE(detail::sampledMesh({&source, 1}).triangles.empty());
}

TEST(SlicedShapes, TreesAreKeptInAFolder) {
    const std::filesystem::path folder =
        std::filesystem::path(testing::TempDir()) / ("grapeshot_trees_" + std::to_string(sizeof(btScalar)));
    std::filesystem::remove_all(folder);
    EXPECT_EQ(keepTrees(nullptr), Status::nullPointer);
    ASSERT_EQ(keepTrees(folder.c_str()), Status::ok);
    const TreeCounts before = treeCounts();
    const MeshShape floor(scenes::grid(2, 2, 40, 43), Kind::bvh);
    EXPECT_EQ(prebuild(floor.get()), Status::ok);
    EXPECT_EQ(treeCounts().built, before.built + 1);
    EXPECT_EQ(treeCounts().loaded, before.loaded);
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 1);
    EXPECT_EQ(keepTrees(""), Status::ok);
    std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace grapeshot::test
