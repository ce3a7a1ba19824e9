// Finding by finding: a world that has it, and the same world without.
#include <grapeshot/plugin/diagnose.hpp>

#include <BulletCollision/Gimpact/btGImpactCollisionAlgorithm.h>
#include <gmock/gmock.h>

#include <limits>
#include <optional>
#include <sstream>

#include "bullet_fixture.hpp"
#include "own_concave_shape.hpp"

namespace grapeshot::test {
namespace {

constexpr btScalar nan = std::numeric_limits<btScalar>::quiet_NaN();

template <class World>
std::optional<Finding> find(const World& world, FindingCode code) {
    const Diagnosis diagnosis = diagnose(&world.world);
    EXPECT_EQ(diagnosis.status, Status::ok);
    for (const Finding& finding : diagnosis.findings) {
        if (finding.code == code) {
            return finding;
        }
    }
    return std::nullopt;
}

struct Diagnosing : testing::Test {
    MeshShape box{scenes::box({0.5F, 0.5F, 0.5F}, 2)};
    MeshShape bvh{scenes::box({0.5F, 0.5F, 0.5F}, 2), Kind::bvh};
};

TEST_F(Diagnosing, AHealthyWorldHasNothingToReport) {
    TestWorld world;
    world.add(*bvh, at({0, 0, 0}));
    world.add(*box, at({0, 1.1_s, 0}), 1);
    world.add(*box, at({0, 2.2_s, 0}), 1);
    world.step(10);
    const Diagnosis diagnosis = diagnose(&world.world);
    EXPECT_EQ(diagnosis.status, Status::ok);
    EXPECT_EQ(toText(diagnosis), "nothing to report\n");
}

TEST_F(Diagnosing, NullAndAForeignDispatcherHaveAName) {
    EXPECT_EQ(diagnose(nullptr).status, Status::nullPointer);
    EXPECT_EQ(toText(diagnose(nullptr)), "no diagnosis: null pointer\n");
}

TEST_F(Diagnosing, PairsWithoutAnAlgorithm) {
    TestWorld world({}, false);
    world.add(*bvh, at({0, 0, 0}));
    world.add(*bvh, at({0, 1.1_s, 0}), 1);
    world.add(*bvh, at({0, 2.2_s, 0}), 1);
    const auto finding = find(world, FindingCode::noAlgorithm);
    ASSERT_TRUE(finding);
    EXPECT_EQ(finding->severity, Severity::error);
    EXPECT_EQ(finding->first, 0);
    EXPECT_EQ(finding->second, 1);
    EXPECT_EQ(finding->value, 2);  // the static one with each of the others; those two are another kind
    EXPECT_EQ(finding->shape, bvh.get());
    EXPECT_THAT(finding->message, testing::HasSubstr("registerAlgorithms"));
    ASSERT_EQ(registerAlgorithms(&world.dispatcher), Status::ok);
    EXPECT_FALSE(find(world, FindingCode::noAlgorithm));
}

TEST_F(Diagnosing, PairsWithinCompoundsAreSeenAndFilteredOnesAreNot) {
    btCompoundShape compound;
    compound.addChildShape(at({0, 0, 0}), bvh.get());
    TestWorld world({}, false);
    world.add(*bvh, at({0, 0, 0}));
    btRigidBody& mover = world.add(compound, at({0, 1.1_s, 0}), 1);
    EXPECT_TRUE(find(world, FindingCode::noAlgorithm));
    world.world.removeRigidBody(&mover);
    world.world.addRigidBody(&mover, 2, 4);
    EXPECT_FALSE(find(world, FindingCode::noAlgorithm));
}

TEST_F(Diagnosing, ShapesThatNobodyKnows) {
    OwnConcaveShape own;
    TestWorld world;
    world.add(own, at({0, 0, 0}));
    btRigidBody& mesh = world.add(*bvh, at({0, 2, 0}), 1);
    const auto finding = find(world, FindingCode::noAlgorithm);
    ASSERT_TRUE(finding);
    EXPECT_THAT(finding->message, testing::HasSubstr("No algorithm is registered"));
    world.remove(mesh);
    world.add(*box, at({0, 2, 0}), 1);  // Bullet's GImpact algorithm
    EXPECT_FALSE(find(world, FindingCode::noAlgorithm));
}

TEST_F(Diagnosing, GImpactRegisteredAfterOurs) {
    TestWorld world;
    EXPECT_FALSE(find(world, FindingCode::overtaken));
    btGImpactCollisionAlgorithm::registerAlgorithm(&world.dispatcher);
    const auto finding = find(world, FindingCode::overtaken);
    ASSERT_TRUE(finding);
    EXPECT_GT(finding->value, 2);
    ASSERT_EQ(registerAlgorithms(&world.dispatcher), Status::ok);
    EXPECT_FALSE(find(world, FindingCode::overtaken));
}

TEST_F(Diagnosing, PairsOlderThanTheRegistration) {
    TestWorld world({}, false);
    world.add(*bvh, at({0, 0, 0}));
    btRigidBody& mover = world.add(*bvh, at({0, 1.01_s, 0}), 1);
    world.step();
    ASSERT_EQ(registerAlgorithms(&world.dispatcher), Status::ok);
    const auto finding = find(world, FindingCode::oldAlgorithm);
    ASSERT_TRUE(finding);
    EXPECT_EQ(finding->value, 1);
    EXPECT_EQ(finding->second, 1);
    world.world.getPairCache()->cleanProxyFromPairs(mover.getBroadphaseHandle(), &world.dispatcher);
    world.step();
    EXPECT_FALSE(find(world, FindingCode::oldAlgorithm));
}

TEST_F(Diagnosing, BodiesWithoutMassThatMeet) {
    TestWorld world;
    world.add(*bvh, at({0, 0, 0}));
    btRigidBody& other = world.add(*bvh, at({0, 0.5_s, 0}));
    EXPECT_FALSE(find(world, FindingCode::zeroMassPair));
    world.world.removeRigidBody(&other);
    world.world.addRigidBody(&other, btBroadphaseProxy::DefaultFilter, btBroadphaseProxy::AllFilter);
    const auto finding = find(world, FindingCode::zeroMassPair);
    ASSERT_TRUE(finding);
    EXPECT_EQ(finding->severity, Severity::note);
    EXPECT_FALSE(find(world, FindingCode::noAlgorithm));
}

TEST_F(Diagnosing, PosesThatAreNoNumber) {
    TestWorld world;
    world.add(*bvh, at({0, 0, 0}));
    btRigidBody& body = world.add(*box, at({0, 1.1_s, 0}), 1);
    EXPECT_FALSE(find(world, FindingCode::notFinite));
    body.setWorldTransform(at({0, nan, 0}));
    const auto finding = find(world, FindingCode::notFinite);
    ASSERT_TRUE(finding);
    EXPECT_EQ(finding->first, 1);
    EXPECT_EQ(finding->severity, Severity::error);
    body.setWorldTransform(at({0, 1, 0}));
    body.setAngularVelocity({0, 0, nan});
    EXPECT_TRUE(find(world, FindingCode::notFinite));
}

TEST_F(Diagnosing, PosesThatAreNotRigid) {
    TestWorld world;
    btRigidBody& body = world.add(*box, at({0, 1.1_s, 0}), 1);
    EXPECT_FALSE(find(world, FindingCode::notRigid));
    btTransform scaled = at({0, 1, 0});
    scaled.setBasis(scaled.getBasis().scaled({2, 2, 2}));
    body.setWorldTransform(scaled);
    EXPECT_TRUE(find(world, FindingCode::notRigid));
}

TEST_F(Diagnosing, BodiesFarFromTheOrigin) {
    // Where numbers are so far apart depends on the precision: 34 km, or as many light minutes.
    const btScalar far = std::numeric_limits<btScalar>::epsilon() < 1e-10_s ? 3e12_s : 3.4e4_s;
    TestWorld world;
    world.add(*bvh, at({far / 100, 0, 0}));
    EXPECT_FALSE(find(world, FindingCode::farFromOrigin));
    world.add(*box, at({0, 0, -far}), 1);
    const auto finding = find(world, FindingCode::farFromOrigin);
    ASSERT_TRUE(finding);
    EXPECT_EQ(finding->first, 1);
    EXPECT_GT(finding->value, 2e-4);
}

TEST_F(Diagnosing, MovingMeshesThatCannotTurn) {
    TestWorld world;
    btRigidBody& body = world.add(*bvh, at({0, 1, 0}), 1);
    EXPECT_FALSE(find(world, FindingCode::noInertia));
    btVector3 inertia;
    bvh->calculateLocalInertia(1, inertia);
    body.setMassProps(1, inertia);
    EXPECT_TRUE(find(world, FindingCode::noInertia));
    body.setAngularFactor(0);  // as meant
    EXPECT_FALSE(find(world, FindingCode::noInertia));
}

/// What is said of one mesh on a moving body.
std::optional<Finding> findOf(const MeshShape& shape, FindingCode code, bool moves = true) {
    TestWorld world;
    world.add(*shape, at({0, 0, 0}), moves ? 1 : 0, {1, 1, 1});
    const auto finding = find(world, code);
    EXPECT_TRUE(!finding || (finding->first == 0 && finding->shape == shape.get()));
    return finding;
}

TEST_F(Diagnosing, MeshesThatAreRefused) {
    MeshShape broken(scenes::box({0.5F, 0.5F, 0.5F}), Kind::bvh);
    EXPECT_FALSE(findOf(broken, FindingCode::unusableMesh));
    broken.mesh.vertices[3].y() = std::numeric_limits<float>::quiet_NaN();
    const auto finding = findOf(broken, FindingCode::unusableMesh);
    ASSERT_TRUE(finding);
    EXPECT_EQ(finding->severity, Severity::error);
    EXPECT_THAT(finding->message, testing::HasSubstr("vertex 3"));
}

TEST_F(Diagnosing, OpenMeshes) {
    scenes::Mesh open = scenes::box({0.5F, 0.5F, 0.5F});
    open.triangles.pop_back();
    const MeshShape shape(open);
    const auto finding = findOf(shape, FindingCode::openMesh);
    ASSERT_TRUE(finding);
    EXPECT_EQ(finding->severity, Severity::warning);
    EXPECT_EQ(finding->value, 3);
    const auto asFloor = findOf(shape, FindingCode::openMesh, false);
    ASSERT_TRUE(asFloor);
    EXPECT_EQ(asFloor->severity, Severity::note);
    EXPECT_FALSE(findOf(box, FindingCode::openMesh));
}

TEST_F(Diagnosing, MeshesThatAreInsideOut) {
    scenes::Mesh turned = scenes::box({0.5F, 0.5F, 0.5F});
    for (Triangle& triangle : turned.triangles) {
        std::swap(triangle[0], triangle[1]);
    }
    const MeshShape shape(turned);
    const auto finding = findOf(shape, FindingCode::insideOut);
    ASSERT_TRUE(finding);
    EXPECT_NEAR(finding->value, -1, 1e-5);
    EXPECT_FALSE(findOf(shape, FindingCode::openMesh));
    EXPECT_FALSE(findOf(box, FindingCode::insideOut));
}

TEST_F(Diagnosing, DegenerateTriangles) {
    scenes::Mesh mesh = scenes::box({0.5F, 0.5F, 0.5F});
    mesh.triangles.push_back({0, 0, 1});
    const auto finding = findOf(MeshShape(mesh), FindingCode::degenerateTriangles);
    ASSERT_TRUE(finding);
    EXPECT_EQ(finding->value, 1);
    EXPECT_FALSE(findOf(box, FindingCode::degenerateTriangles));
}

TEST_F(Diagnosing, MeshesFarFromTheirOwnOrigin) {
    scenes::Mesh mesh = scenes::box({0.5F, 0.5F, 0.5F}, 32);
    EXPECT_FALSE(findOf(MeshShape(mesh), FindingCode::imprecise));
    for (Eigen::Vector3f& vertex : mesh.vertices) {
        vertex.x() += 8192;
    }
    const MeshShape far(mesh);
    EXPECT_TRUE(findOf(far, FindingCode::imprecise));
    EXPECT_TRUE(findOf(far, FindingCode::huge));
}

TEST_F(Diagnosing, Scale) {
    const auto scaled = [](const btVector3& scale, Kind kind) {
        return MeshShape(scenes::box({0.5F, 0.5F, 0.5F}), kind, 0.01_s, scale);
    };
    for (const Kind kind : {Kind::mesh, Kind::part, Kind::scaledBvh}) {
        EXPECT_FALSE(findOf(scaled({2, 2, 2}, kind), FindingCode::nonUniformScale));
        EXPECT_FALSE(findOf(scaled({-2, 2, 2}, kind), FindingCode::nonUniformScale));
        const auto finding = findOf(scaled({1, 3, 1}, kind), FindingCode::nonUniformScale);
        ASSERT_TRUE(finding);
        EXPECT_NEAR(finding->value, 3, 1e-5);
        EXPECT_FALSE(findOf(scaled({1, 3, 1}, kind), FindingCode::badScale));
    }
    MeshShape child(scenes::box({0.5F, 0.5F, 0.5F}), Kind::scaledBvh, 0.01_s, {1, 0, 1});
    EXPECT_TRUE(findOf(child, FindingCode::badScale));
}

TEST_F(Diagnosing, Size) {
    EXPECT_TRUE(findOf(MeshShape(scenes::box({0.01F, 0.01F, 0.01F}), Kind::mesh, 0), FindingCode::tiny));
    EXPECT_FALSE(findOf(MeshShape(scenes::box({0.01F, 0.01F, 0.01F}), Kind::mesh, 0), FindingCode::tiny, false));
    EXPECT_FALSE(findOf(MeshShape(scenes::box({0.1F, 0.1F, 0.1F})), FindingCode::tiny));
    EXPECT_TRUE(findOf(MeshShape(scenes::grid(9000, 9000, 2, 2), Kind::bvh), FindingCode::huge, false));
    EXPECT_FALSE(findOf(MeshShape(scenes::grid(900, 900, 2, 2), Kind::bvh), FindingCode::huge, false));
}

TEST_F(Diagnosing, Margins) {
    const auto plate = [](btScalar margin) { return MeshShape(scenes::box({1, 0.02F, 1}), Kind::mesh, margin); };
    const auto finding = findOf(plate(0.05_s), FindingCode::largeMargin);
    ASSERT_TRUE(finding);
    EXPECT_NEAR(finding->value, 0.05 / 0.0385, 0.02);
    EXPECT_FALSE(findOf(plate(0.01_s), FindingCode::largeMargin));
    EXPECT_FALSE(findOf(plate(0.01_s), FindingCode::badMargin));
    MeshShape negative(scenes::box({1, 1, 1}), Kind::bvh);
    negative->setMargin(-1);
    EXPECT_TRUE(findOf(negative, FindingCode::badMargin));
    MeshShape none(scenes::box({1, 1, 1}), Kind::bvh);
    none->setMargin(nan);
    EXPECT_TRUE(findOf(none, FindingCode::badMargin));
}

struct Budgeted : testing::Test {
    MeshShape ball{scenes::bumpySphere(0.5F, 0.1F, 5, 12), Kind::mesh, 0.01_s};
    MeshShape floor{scenes::grid(3, 3, 20, 20), Kind::bvh, 0.01_s};
    void fill(BudgetWorld& world) {
        world.add(*floor, at({0, 0, 0}));
        for (int i = 0; i < 3; ++i) {
            world.add(*ball, at({0, 0.55_s + 0.9_s * btScalar(i), 0}), 1);
        }
    }
};

TEST_F(Budgeted, AdviceOnTheBudget) {
    Settings settings;
    settings.frameBudget.work = 4;
    BudgetWorld world(settings);
    fill(world);
    EXPECT_FALSE(find(world, FindingCode::degraded));
    world.step(5);
    ASSERT_GT(world.stats().degraded, 0);
    const auto degraded = find(world, FindingCode::degraded);
    ASSERT_TRUE(degraded);
    EXPECT_EQ(degraded->value, world.stats().degraded);
    EXPECT_THAT(degraded->message, testing::HasSubstr("frameBudget, now 4"));
    const auto mandatory = find(world, FindingCode::mandatoryOverBudget);
    ASSERT_TRUE(mandatory);
    EXPECT_EQ(mandatory->value, static_cast<double>(world.stats().mandatory) / 4);
    EXPECT_FALSE(find(world, FindingCode::refused));

    BudgetWorld rich;
    fill(rich);
    rich.step(5);
    EXPECT_FALSE(find(rich, FindingCode::degraded));
    EXPECT_FALSE(find(rich, FindingCode::mandatoryOverBudget));
}

TEST_F(Budgeted, RefusedPairsAndThoseHandedOn) {
    BudgetWorld world;
    fill(world);
    world.step();
    EXPECT_FALSE(find(world, FindingCode::refused));
    EXPECT_FALSE(find(world, FindingCode::fallbacks));
    OwnConcaveShape own;
    world.add(own, at({0, 0.4_s, 0}), 1, {1, 1, 1});
    btRigidBody& lowest = *world.bodies[1];
    btTransform stretched = lowest.getWorldTransform();
    stretched.setBasis(stretched.getBasis().scaled({1.5_s, 1, 1}));
    lowest.setWorldTransform(stretched);
    world.step();
    const auto refused = find(world, FindingCode::refused);
    ASSERT_TRUE(refused);
    EXPECT_EQ(refused->value, world.stats().refused);
    EXPECT_TRUE(find(world, FindingCode::fallbacks));
    for (int i = 0; i < 2; ++i) {
        world.remove(*world.bodies.back());  // before its shape goes
    }
}

TEST(DiagnosingRegions, MoreRegionsThanManifolds) {
    scenes::Mesh corner;  // a floor and a wall
    corner.vertices = {{-1, 0, -1}, {1, 0, -1}, {1, 0, 1}, {-1, 0, 1}, {-1, 1, -1}, {-1, 1, 1}};
    corner.triangles = {{0, 2, 1}, {0, 3, 2}, {0, 4, 5}, {0, 5, 3}};
    const MeshShape room(corner, Kind::bvh, 0);
    const MeshShape block(scenes::box({0.25F, 0.25F, 0.25F}, 2), Kind::mesh, 0);
    for (const int manifolds : {1, 8}) {
        Settings settings;
        settings.maxManifolds = manifolds;
        TestWorld world(settings);
        world.add(*room, at({0, 0, 0}));
        world.add(*block, at({-0.747_s, 0.253_s, 0}), 1);
        world.step();
        EXPECT_EQ(find(world, FindingCode::droppedRegions).has_value(), manifolds == 1);
    }
}

TEST_F(Diagnosing, TextHasTheWorstFirstAndEverythingAPersonNeeds) {
    scenes::Mesh open = scenes::box({0.5F, 0.5F, 0.5F});
    open.triangles.pop_back();
    const MeshShape floor(open, Kind::bvh);
    TestWorld world({}, false);
    world.add(*floor, at({0, 0, 0}));
    world.add(*bvh, at({0, 3, 0}), 1);
    std::ostringstream out;
    out << diagnose(&world.world);
    const std::string text = out.str();
    EXPECT_THAT(text, testing::StartsWith("error: noAlgorithm (bodies 0 and 1): BVHTRIANGLEMESH against "));
    EXPECT_THAT(text, testing::HasSubstr("\nnote: openMesh (body 0): "));
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 2);
}

}  // namespace
}  // namespace grapeshot::test
