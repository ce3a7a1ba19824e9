// Shapes that change under us: edits in place, other scales and margins, other shapes at the same address.
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <limits>
#include <new>

#include <grapeshot/adb/tree_file.hpp>
#include <grapeshot/plugin/detail/shape_models.hpp>

#include "bullet_fixture.hpp"

namespace grapeshot::test {
namespace {

using detail::Check;
using detail::Pace;
using detail::ShapeEntry;
using detail::ShapeModel;

struct Entries : testing::Test {
    ModelCache cache;
    ShapeEntry entry;
    std::shared_ptr<const ShapeModel> look(const MeshShape& shape, Check check = Check::sampled,
                                           std::uint64_t step = 0) {
        return entry.model(*shape, cache, check, step);
    }
};

TEST_F(Entries, NothingChangedNothingBuilt) {
    const MeshShape shape(scenes::torus(1, 0.3F, 40, 20));
    const auto first = look(shape);
    ASSERT_TRUE(first->mesh) << first->error;
    for (int i = 0; i < 10; ++i) {
        EXPECT_EQ(look(shape), first);
        EXPECT_EQ(look(shape, Check::thorough), first);
    }
    EXPECT_EQ(cache.counts().builds, 1U);
}

TEST_F(Entries, ShapesWithTheSameContentShareAModel) {
    const MeshShape first(scenes::torus(1, 0.3F, 40, 20));
    const MeshShape second(scenes::torus(1, 0.3F, 40, 20), Kind::bvh);
    ShapeEntry other;
    EXPECT_EQ(look(first)->mesh, other.model(*second, cache, Check::sampled, 0)->mesh);
}

TEST_F(Entries, AMovedVertexIsFoundWithinARoundOfSamplesAndRefitted) {
    MeshShape shape(scenes::torus(1, 0.3F, 60, 30));  // 1800 vertices: a sample is a 28th
    const auto before = look(shape);
    shape.mesh.vertices[1234] *= 1.1F;
    auto after = before;
    for (int i = 0; i < 30 && after == before; ++i) {
        after = look(shape);
    }
    ASSERT_NE(after, before);
    EXPECT_EQ(after->topology, before->topology);
    EXPECT_EQ(after->mesh->tree.vertices[1234], shape.mesh.vertices[1234]);
    EXPECT_EQ(cache.counts().builds, 1U);
    EXPECT_TRUE(findings(after->mesh->tree).empty());
    // The old model is as it was, for whoever still uses it.
    EXPECT_NE(before->mesh->tree.vertices[1234], shape.mesh.vertices[1234]);
}

TEST_F(Entries, ANotifiedEditIsFoundAtOnce) {
    MeshShape shape(scenes::torus(1, 0.3F, 60, 30));
    const auto before = look(shape, Check::sampled, 7);
    shape.mesh.vertices[1234] *= 1.1F;
    EXPECT_EQ(look(shape, Check::sampled, 7), before);  // only once a step
    entry.notifyChanged();
    EXPECT_NE(look(shape, Check::sampled, 7), before);
}

TEST_F(Entries, OtherTrianglesMakeAnotherTopology) {
    MeshShape shape(scenes::box({0.5F, 0.5F, 0.5F}));
    const auto before = look(shape);
    std::swap(shape.mesh.triangles[0], shape.mesh.triangles[1]);
    const auto after = look(shape);
    EXPECT_NE(after->topology, before->topology);
    EXPECT_EQ(after->mesh->tree.triangles[0], shape.mesh.triangles[0]);
}

TEST_F(Entries, ScaleIsNoticed) {
    const MeshShape shape(scenes::box({0.5F, 0.5F, 0.5F}));
    const auto before = look(shape);
    shape.shape->setLocalScaling({2, 2, 2});
    const auto after = look(shape);
    EXPECT_EQ(after->topology, before->topology);
    EXPECT_FLOAT_EQ(after->mesh->tree.upper.x(), 1);
}

TEST_F(Entries, ABadEditIsRefusedAndAGoodOneTakenAgain) {
    MeshShape shape(scenes::box({0.5F, 0.5F, 0.5F}));
    ASSERT_TRUE(look(shape)->mesh);
    const float good = shape.mesh.vertices[2].x();
    shape.mesh.vertices[2].x() = std::numeric_limits<float>::quiet_NaN();
    EXPECT_FALSE(look(shape)->mesh);
    EXPECT_THAT(look(shape)->error, testing::HasSubstr("2"));
    shape.mesh.vertices[2].x() = good;
    entry.notifyChanged();
    EXPECT_TRUE(look(shape)->mesh);
    shape.shape->setLocalScaling({0, 1, 1});
    EXPECT_FALSE(look(shape)->mesh);
    shape.shape->setLocalScaling({1, 1, 1});
    EXPECT_TRUE(look(shape)->mesh);
}

TEST_F(Entries, AnotherShapeAtTheSameAddressIsAnotherShape) {
    const MeshShape small(scenes::torus(1, 0.3F, 60, 30), Kind::bvh);
    MeshShape large(scenes::torus(1, 0.3F, 60, 30), Kind::bvh);
    large.mesh.vertices[1234] *= 1.1F;  // differs in one place that a sample would hardly see
    alignas(btGImpactMeshShape) unsigned char place[sizeof(btGImpactMeshShape)];
    auto* shape = new (place) btGImpactMeshShape(small.arrays.get());
    const auto first = entry.model(*shape, cache, Check::thorough, 0);
    shape->~btGImpactMeshShape();
    shape = new (place) btGImpactMeshShape(large.arrays.get());
    const auto second = entry.model(*shape, cache, Check::thorough, 0);
    shape->~btGImpactMeshShape();
    EXPECT_NE(first, second);
    EXPECT_EQ(second->mesh->tree.vertices[1234], large.mesh.vertices[1234]);
}

// Nobody holds the shape while its tree is being built; another one takes its place, and its arrays'.
TEST(ShapeEdit, ABuildGoesOnOnlyIfTheShapeIsTheSame) {
    const MeshShape other(scenes::bumpySphere(1, 0.3F, 5, 20), Kind::bvh);
    std::array<std::uint64_t, 2> spent{};
    for (const bool changes : {false, true}) {
        MeshShape shape(scenes::bumpySphere(1, 0.1F, 5, 20), Kind::bvh);
        ShapeEntry own;
        ModelCache empty;
        std::uint64_t work = 0;
        own.model(*shape, empty, Check::thorough, 1, Pace::inSlices, work);
        const std::uint64_t before = own.goOnBuilding({.work = 2000});
        ASSERT_TRUE(own.isBuilding());
        if (changes) {
            std::ranges::copy(other.mesh.vertices, shape.mesh.vertices.begin());
        }
        own.letGo();
        own.model(*shape, empty, Check::thorough, 2, Pace::inSlices, work);
        while (own.isBuilding()) {
            spent[changes ? 1 : 0] += own.goOnBuilding({.work = 1000});
        }
        spent[changes ? 1 : 0] += changes ? 0 : before;
        ASSERT_TRUE(own.present()->mesh);
        EXPECT_EQ(contentKey(own.present()->mesh->tree), contentKey(build(shape.mesh.view(), {.tuningPoses = 0})));
    }
    EXPECT_NEAR(static_cast<double>(spent[0]), static_cast<double>(spent[1]), 0.02 * static_cast<double>(spent[1]))
        << "what was done is not done again if it is the same";
}

TEST(ShapeEdit, ATreeDoesNotDependOnWhatWasAtTheAddressBefore) {
    const MeshShape round(scenes::bumpySphere(1, 0, 5, 8), Kind::bvh);
    const MeshShape bumpy(scenes::bumpySphere(1, 0.3F, 5, 8), Kind::bvh);
    ASSERT_EQ(round.mesh.triangles, bumpy.mesh.triangles);
    alignas(btGImpactMeshShape) unsigned char place[sizeof(btGImpactMeshShape)];
    for (const MeshShape* source : {&round, &bumpy, &round}) {
        auto* shape = new (place) btGImpactMeshShape(source->arrays.get());
        EXPECT_EQ(prebuild(shape), Status::ok);
        const auto model = detail::ShapeModels::instance().present(*shape);
        shape->~btGImpactMeshShape();
        ASSERT_TRUE(model && model->mesh);
        EXPECT_EQ(contentKey(model->mesh->tree), contentKey(build(source->mesh.view(), {.tuningPoses = 0})));
    }
}

TEST(ShapeEdit, PrebuildSaysWhetherItCan) {
    const MeshShape good(scenes::box({0.5F, 0.5F, 0.5F}));
    EXPECT_EQ(prebuild(good.get()), Status::ok);
    EXPECT_EQ(prebuild(nullptr), Status::nullPointer);
    const btBoxShape box({1, 1, 1});
    EXPECT_EQ(prebuild(&box), Status::unsupportedShape);
    MeshShape bad(scenes::box({0.5F, 0.5F, 0.5F}));
    bad.mesh.vertices[0].x() = std::numeric_limits<float>::infinity();
    EXPECT_EQ(prebuild(bad.get()), Status::unusableMesh);
    notifyChanged(nullptr);
    notifyChanged(&box);
}

TEST(ShapeEdit, ABodyFollowsAFloorThatSinks) {
    MeshShape floor(scenes::box({2, 0.5F, 2}, 4), Kind::mesh, 0.01_s);
    const MeshShape box(scenes::box({0.3F, 0.3F, 0.3F}), Kind::mesh, 0.01_s);
    for (const bool notified : {false, true}) {
        TestWorld world;
        world.add(*floor, at({0, 0, 0}));
        btRigidBody& body = world.add(*box, at({0, 0.82_s, 0}), 1);
        body.setActivationState(DISABLE_DEACTIVATION);
        world.step(60);
        EXPECT_NEAR(body.getWorldTransform().getOrigin().y(), 0.82, 0.01);
        for (Eigen::Vector3f& v : floor.mesh.vertices) {
            v.y() -= 0.2F;
        }
        if (notified) {
            notifyChanged(floor.get());
        }
        world.step(60);
        EXPECT_NEAR(body.getWorldTransform().getOrigin().y(), 0.62, 0.01);
        for (Eigen::Vector3f& v : floor.mesh.vertices) {
            v.y() += 0.2F;
        }
    }
}

TEST(ShapeEdit, ALivePairGetsOtherShapes) {
    const MeshShape box(scenes::box({0.5F, 0.5F, 0.5F}), Kind::mesh, 0.01_s);
    const MeshShape flat(scenes::box({0.5F, 0.2F, 0.5F}), Kind::bvh, 0.01_s);
    btSphereShape sphere(0.5_s);
    btBoxShape bulletBox({0.5_s, 0.5_s, 0.5_s});
    btCompoundShape compound;
    compound.addChildShape(at({0, 0, 0}), flat.get());
    TestWorld world;
    btRigidBody& lower = world.add(*box, at({0, 0, 0}));
    btRigidBody& upper = world.add(*box, at({0, 1.03_s, 0}), 1);
    upper.setActivationState(DISABLE_DEACTIVATION);
    world.step(60);
    const auto expectHeight = [&](btScalar height, const char* what) {
        world.step(90);
        EXPECT_NEAR(upper.getWorldTransform().getOrigin().y(), height, 0.02) << what;
    };
    expectHeight(1.02_s, "mesh on mesh");
    upper.setCollisionShape(flat.get());
    expectHeight(0.72_s, "another kind");
    upper.setCollisionShape(box.get());
    upper.translate({0, 0.4_s, 0});
    upper.setCollisionShape(&sphere);
    expectHeight(1.01_s, "a sphere on a mesh");
    lower.setCollisionShape(&bulletBox);
    expectHeight(1.0_s, "two convex shapes: not ours");
    lower.setCollisionShape(box.get());
    upper.setCollisionShape(&compound);
    upper.getWorldTransform().setBasis(btMatrix3x3::getIdentity());
    upper.setAngularVelocity({0, 0, 0});
    upper.translate({0, 0.1_s, 0});
    expectHeight(0.72_s, "a compound: Bullet's recursion, with ours in it");
}

}  // namespace
}  // namespace grapeshot::test
