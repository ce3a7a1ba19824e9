// What a program sees of the triangles at a contact, and that bodies slide over them as if there were none.
#include <BulletCollision/CollisionShapes/btTriangleShape.h>
#include <gmock/gmock.h>

#include <cmath>

#include "bullet_fixture.hpp"

namespace grapeshot::test {
namespace {

struct Seen {
    bool isTriangle = false;
    bool parentIsMesh = false;
    bool namesAgree = false;
    btScalar lowest = 0, highest = 0;  ///< of the triangle, world
};
std::vector<std::array<Seen, 2>> seen;

Seen look(const btCollisionObjectWrapper& wrap, int part, int index) {
    Seen result;
    result.isTriangle = wrap.getCollisionShape()->getShapeType() == TRIANGLE_SHAPE_PROXYTYPE;
    result.parentIsMesh = wrap.m_parent != nullptr &&
                          wrap.m_parent->getCollisionShape() == wrap.getCollisionObject()->getCollisionShape();
    result.namesAgree = wrap.m_partId == part && wrap.m_index == index && index >= 0;
    if (result.isTriangle) {
        const auto& triangle = static_cast<const btTriangleShape&>(*wrap.getCollisionShape());
        result.lowest = result.highest = (wrap.getWorldTransform() * triangle.m_vertices1[0]).y();
        for (const btVector3& corner : triangle.m_vertices1) {
            result.lowest = btMin(result.lowest, (wrap.getWorldTransform() * corner).y());
            result.highest = btMax(result.highest, (wrap.getWorldTransform() * corner).y());
        }
    }
    return result;
}

bool onAdded(btManifoldPoint& point, const btCollisionObjectWrapper* first, int part0, int index0,
             const btCollisionObjectWrapper* second, int part1, int index1) {
    EXPECT_EQ(point.m_index0, index0);
    EXPECT_EQ(point.m_index1, index1);
    seen.push_back({look(*first, part0, index0), look(*second, part1, index1)});
    return false;
}

TEST(Materials, TheCallbackSeesTheTrianglesOfBothMeshesInEitherOrder) {
    const MeshShape floor(scenes::box({2, 0.5F, 2}, 4), Kind::bvh, 0.01_s);
    const MeshShape block(scenes::box({0.4F, 0.4F, 0.4F}, 2), Kind::mesh, 0.01_s);
    for (const bool blockFirst : {false, true}) {
        TestWorld world;
        btRigidBody* first = blockFirst ? &world.add(*block, at({0, 0.915_s, 0}), 1) : nullptr;
        btRigidBody& ground = world.add(*floor, at({0, 0, 0}));
        btRigidBody& body = first != nullptr ? *first : world.add(*block, at({0, 0.915_s, 0}), 1);
        ground.setCollisionFlags(ground.getCollisionFlags() | btCollisionObject::CF_CUSTOM_MATERIAL_CALLBACK);
        seen.clear();
        gContactAddedCallback = onAdded;
        world.step();
        gContactAddedCallback = nullptr;
        ASSERT_EQ(seen.size(), 4U);
        const bool blockIs0 = world.dispatcher.getManifoldByIndexInternal(0)->getBody0() == &body;
        for (const auto& pair : seen) {
            for (const Seen& side : pair) {
                EXPECT_TRUE(side.isTriangle && side.parentIsMesh && side.namesAgree);
            }
            EXPECT_NEAR(pair[blockIs0 ? 1 : 0].lowest, 0.5, 1e-4);
            EXPECT_NEAR(pair[blockIs0 ? 1 : 0].highest, 0.5, 1e-4);
        }
    }
}

TEST(Materials, QueriesSeeTheTrianglesToo) {
    const MeshShape floor(scenes::box({2, 0.5F, 2}, 4), Kind::bvh, 0.01_s);
    const MeshShape block(scenes::box({0.4F, 0.4F, 0.4F}, 2), Kind::mesh, 0.01_s);
    btCollisionObject objects[2];
    objects[0].setCollisionShape(floor.get());
    objects[1].setCollisionShape(block.get());
    objects[1].setWorldTransform(at({0, 0.915_s, 0}));
    TestWorld world;
    struct Looking : Collector {
        btScalar addSingleResult(btManifoldPoint& point, const btCollisionObjectWrapper* first, int part0, int index0,
                                 const btCollisionObjectWrapper* second, int part1, int index1) override {
            seen.push_back({look(*first, part0, index0), look(*second, part1, index1)});
            return Collector::addSingleResult(point, first, part0, index0, second, part1, index1);
        }
    } looking;
    seen.clear();
    world.world.contactPairTest(&objects[0], &objects[1], looking);
    ASSERT_FALSE(seen.empty());
    for (const auto& pair : seen) {
        EXPECT_TRUE(pair[0].parentIsMesh && pair[1].parentIsMesh);
    }
}

/// Pushes a body over flat ground of small triangles; returns how much it leaves the plane, m/s and m.
struct Slide {
    Slide(btCollisionShape& shape, btScalar height, btCollisionShape& ground, const Settings& settings) {
        TestWorld world(settings);
        btRigidBody& floor = world.add(ground, at({0, 0, 0}));
        floor.setFriction(0.3_s);
        btRigidBody& body = world.add(shape, at({-3, height, 0.07_s}), 1, {0.1_s, 0.1_s, 0.1_s});
        body.setFriction(0.3_s);
        body.setActivationState(DISABLE_DEACTIVATION);
        world.step(60);
        const btScalar rest = body.getWorldTransform().getOrigin().y();
        body.setLinearVelocity({3, 0, 0.4_s});
        for (int i = 0; i < 90; ++i) {
            body.setLinearVelocity({3, body.getLinearVelocity().y(), 0.4_s});
            world.step();
            kick = btMax(kick, body.getLinearVelocity().y());
            rise = btMax(rise, body.getWorldTransform().getOrigin().y() - rest);
            lean = btMax(lean, btSqrt(body.getAngularVelocity().x() * body.getAngularVelocity().x() +
                                      body.getAngularVelocity().z() * body.getAngularVelocity().z()));
        }
    }
    btScalar kick = 0, rise = 0, lean = 0;
};

TEST(InnerEdges, NothingBumpsOnFlatGround) {
    const MeshShape ground(scenes::grid(4, 4, 53, 47), Kind::bvh, 0.01_s);
    const MeshShape block(scenes::box({0.25F, 0.2F, 0.25F}, 3), Kind::mesh, 0.01_s);
    btBoxShape box({0.25_s, 0.2_s, 0.25_s});
    btSphereShape ball(0.2_s);
    btCylinderShape cylinder({0.25_s, 0.2_s, 0.25_s});
    Settings settings;
    settings.bvhConvexPairs = true;
    struct Case {
        btCollisionShape* shape;
        btScalar height;
        double kick = 0.02;
    };
    // GJK finds one point of a lid at a time: a cylinder rocks a little.
    for (const Case& item :
         {Case{block.get(), 0.22_s}, Case{&box, 0.21_s}, Case{&ball, 0.21_s}, Case{&cylinder, 0.21_s, 0.1}}) {
        const Slide slide(*item.shape, item.height, *ground, settings);
        EXPECT_LT(slide.kick, item.kick) << item.shape->getName();
        EXPECT_LT(slide.rise, 0.002) << item.shape->getName();
    }
}

TEST(TakingOver, ConvexBodiesBelowATrianglesPlaneKeepTheirContacts) {
    // Bullet 3.24 looks at each triangle alone, and leaves out those behind which most of the body is.
    const MeshShape ground(scenes::moved(scenes::box({2, 0.5F, 2}, 4), {0, -0.5F, 0}), Kind::bvh, 0.01_s);
    btBoxShape box({0.2_s, 0.2_s, 0.2_s});
    int bullets = 0;
    int ours = 0;
    int all = 0;
    for (const bool taken : {false, true}) {
        Settings settings;
        settings.bvhConvexPairs = taken;
        for (const btScalar depth : {0.05_s, 0.15_s, 0.25_s, 0.35_s}) {
            TestWorld world(settings);
            world.add(*ground, at({0, 0, 0}));
            world.add(box, at({0.1_s, 0.2_s - depth, 0.13_s}), 1);
            world.world.performDiscreteCollisionDetection();
            bool up = false;
            for (const btManifoldPoint& point : world.points()) {
                const bool boxIs0 = world.dispatcher.getManifoldByIndexInternal(0)->getBody0() != world.bodies[0].get();
                up = up || (boxIs0 ? point.m_normalWorldOnB.y() : -point.m_normalWorldOnB.y()) > 0.9;
            }
            (taken ? ours : bullets) += up ? 1 : 0;
            all += taken ? 1 : 0;
        }
    }
    EXPECT_EQ(ours, all);
    EXPECT_LT(bullets, all) << "the scene does not need it";
}

}  // namespace
}  // namespace grapeshot::test
