#include <grapeshot/narrowphase/convex_contacts.hpp>
#include <grapeshot/narrowphase/detail/box_cut.hpp>

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <scenes/shapes.hpp>
#include <scenes/true_penetration.hpp>
#include <support/poses.hpp>
#include <support/test_size.hpp>

#include "triangle_pairs.hpp"

namespace grapeshot {
namespace {

using Eigen::Matrix3f;
using Eigen::Vector3d;
using Eigen::Vector3f;
using ContactList = std::vector<SurfaceContact>;

constexpr float reach = 0.06F;

struct Body {
    const char* name;
    MeshModel model;
    scenes::TrueSurface truth;
    Body(const char* bodyName, const scenes::Mesh& mesh)
        : name(bodyName), model(makeModel(mesh.view())), truth(mesh.view()) {}
};

const std::vector<Body>& bodies() {
    static const std::vector<Body> all = [] {
        std::vector<Body> list;
        list.emplace_back("cube", scenes::box({0.4F, 0.5F, 0.3F}, 2));
        list.emplace_back("sphere", scenes::sphere(0.5F, 5));
        list.emplace_back("torus", scenes::torus(0.5F, 0.2F, 18, 10));
        list.emplace_back("cup", scenes::cup(0.5F, 0.1F, 0.8F, 14, 3));
        list.emplace_back("bumpy", scenes::bumpySphere(0.5F, 0.3F, 5, 5));
        list.emplace_back("comb", scenes::comb(4, 0.4F, 0.25F, 0.12F));
        return list;
    }();
    return all;
}

Vector3f inflatedPoint(const MeshModel& model, test::Random& random, float margin) {
    Vector3f x;
    for (int axis = 0; axis < 3; ++axis) {
        x[axis] = static_cast<float>(random.uniform(model.tree.lower[axis] - margin, model.tree.upper[axis] + margin));
    }
    return x;
}

/// What holds for every contact: unit normal, points on a line along it, onA on the mesh (in the middle of a cut, if
/// that is where a contact may come from: half the depth off).
void expectConsistent(const Body& body, const ContactList& contacts, const std::string& where, bool orCut = false) {
    for (const SurfaceContact& contact : contacts) {
        EXPECT_NEAR(contact.normal.norm(), 1, 1e-5F) << where << testing::PrintToString(contact);
        EXPECT_LE(contact.signedDistance, reach) << where;
        EXPECT_LT((contact.onB + contact.signedDistance * contact.normal - contact.onA).norm(), 1e-5F)
            << where << testing::PrintToString(contact);
        const double off = 2e-5 + (orCut && contact.signedDistance < 0 ? -0.5 * contact.signedDistance : 0);
        EXPECT_NEAR(body.truth.signedDistance(contact.onA.cast<double>()), 0, off)
            << where << testing::PrintToString(contact);
        EXPECT_LT(contact.triangleA, body.model.tree.triangles.size()) << where;
        EXPECT_EQ(contact.triangleB, noTriangle) << where;
    }
}

// Plane

TEST(PlaneContacts, TheDeepestVertexIsThereHoweverDeep) {
    test::Random random(1);
    for (const Body& body : bodies()) {
        int contactsSeen = 0;
        for (std::size_t i = 0; i < test::sampleSize(60, 2000); ++i) {
            const Vector3f normal = random.direction();
            const PlaneSolid plane{normal, static_cast<float>(random.uniform(-0.8, 2))};
            ContactList contacts;
            const std::uint64_t work = planeContacts(body.model, plane, reach, {}, contacts);
            float lowest = 1e9F;
            for (const Vector3f& vertex : body.model.tree.vertices) {
                lowest = std::min(lowest, normal.dot(vertex) - plane.offset);
            }
            const std::string where = std::string(body.name) + ", sample " + std::to_string(i) + ": ";
            expectConsistent(body, contacts, where);
            EXPECT_EQ(contacts.empty(), lowest > reach) << where << lowest;
            if (!contacts.empty()) {
                EXPECT_NEAR(test::deepest(contacts)->signedDistance, lowest, 1e-5F) << where;
                EXPECT_GE(work, 1U);
            }
            EXPECT_LE(work, (body.model.tree.triangles.size() + 15) / 16);
            for (const SurfaceContact& contact : contacts) {
                EXPECT_EQ(contact.normal, normal);
                EXPECT_NEAR(normal.dot(contact.onB), plane.offset, 1e-5F) << where;
            }
            contactsSeen += static_cast<int>(contacts.size());
        }
        EXPECT_GT(contactsSeen, 30) << body.name;
    }
}

TEST(PlaneContacts, ABlockLyingFlatHasItsCornersOnly) {
    const MeshModel block = makeModel(scenes::box({0.5F, 0.25F, 0.4F}).view());
    for (const float gap : {0.05F, 0.0F, -0.01F, -0.4F, -30.0F}) {
        ContactList contacts;
        planeContacts(block, {Vector3f::UnitY(), -0.25F - gap}, reach, {}, contacts);
        ASSERT_EQ(contacts.size(), 4U) << gap;
        for (const SurfaceContact& contact : contacts) {
            EXPECT_NEAR(contact.signedDistance, gap, 1e-5F);
            EXPECT_NEAR(std::abs(contact.onA.x()), 0.5F, 1e-6F);
        }
    }
}

// Few contacts, all near the bottom: what is sunk, but no extremum, adds nothing.
TEST(PlaneContacts, ARoundBodyHasItsBottomOnly) {
    const MeshModel ball = makeModel(scenes::sphere(1, 16).view());
    ContactList contacts;
    planeContacts(ball, {Vector3f::UnitY(), -0.5F}, reach, {}, contacts);
    ASSERT_FALSE(contacts.empty());
    EXPECT_LE(contacts.size(), 30U);
    for (const SurfaceContact& contact : contacts) {
        EXPECT_LT(contact.onA.y(), -0.97F);
    }
}

TEST(PlaneContacts, AHollowsCeilingIsNoContact) {
    // A shell: the inner surface's lowest vertices are bottoms of a hole.
    scenes::Mesh inner = scenes::sphere(0.9F, 6);
    for (Triangle& triangle : inner.triangles) {
        std::swap(triangle[0], triangle[1]);
    }
    const MeshModel shell = makeModel(scenes::merged(scenes::sphere(1, 6), inner).view());
    ASSERT_TRUE(shell.solid);
    ContactList contacts;
    planeContacts(shell, {Vector3f::UnitY(), 0.0F}, reach, {}, contacts);
    ASSERT_FALSE(contacts.empty());
    for (const SurfaceContact& contact : contacts) {
        EXPECT_NEAR(contact.onA.norm(), 1, 1e-3F) << testing::PrintToString(contact);
    }
}

// Sphere

TEST(SphereContacts, TheDeepestIsTheSignedDistanceOfTheCentre) {
    test::Random random(2);
    for (const Body& body : bodies()) {
        int inside = 0;
        int outside = 0;
        int none = 0;
        for (std::size_t i = 0; i < test::sampleSize(400, 10000); ++i) {
            const SphereSolid sphere{inflatedPoint(body.model, random, 0.3F),
                                     static_cast<float>(random.uniform(0.0, 0.3))};
            ContactList contacts;
            sphereContacts(body.model, sphere, reach, {}, contacts);
            const double truth = body.truth.signedDistance(sphere.center.cast<double>()) - sphere.radius;
            const std::string where = std::string(body.name) + ", sample " + std::to_string(i) + ": ";
            expectConsistent(body, contacts, where);
            if (std::abs(truth - reach) < 1e-4) {
                continue;
            }
            ASSERT_EQ(contacts.empty(), truth > reach) << where << truth;
            if (contacts.empty()) {
                ++none;
                continue;
            }
            const SurfaceContact* contact = test::deepest(contacts);
            EXPECT_NEAR(contact->signedDistance, truth, 1e-5) << where;
            EXPECT_NEAR((contact->onB - sphere.center).norm(), sphere.radius, 1e-5F) << where;
            (truth < -sphere.radius ? inside : outside) += 1;
        }
        EXPECT_GT(inside, 8) << body.name;
        EXPECT_GT(outside, 50) << body.name;
        EXPECT_GT(none, 3) << body.name;
    }
}

// A room's corner: floor and two walls of a sheet, seen from within.
TEST(SphereContacts, ABallInACornerTouchesEveryWall) {
    scenes::Mesh room;
    room.vertices = {{0, 0, 0}, {2, 0, 0}, {2, 0, 2}, {0, 0, 2}, {0, 2, 0}, {0, 2, 2}, {2, 2, 0}};
    room.triangles = {{0, 2, 1}, {0, 3, 2}, {0, 4, 5}, {0, 5, 3}, {0, 1, 6}, {0, 6, 4}};
    const MeshModel model = makeModel(room.view());
    ContactList contacts;
    sphereContacts(model, {{0.11F, 0.12F, 0.09F}, 0.1F}, reach, {}, contacts);
    ASSERT_EQ(contacts.size(), 3U);
    for (int axis = 0; axis < 3; ++axis) {
        const float expected = Vector3f(0.01F, 0.02F, -0.01F)[axis];
        EXPECT_TRUE(std::any_of(contacts.begin(), contacts.end(), [&](const SurfaceContact& contact) {
            return contact.normal[axis] < -0.9999F && std::abs(contact.signedDistance - expected) < 1e-5F;
        })) << axis;
    }
}

TEST(SphereContacts, ASheetPushesToTheCentresSide) {
    const MeshModel sheet = makeModel(scenes::grid(1, 1, 4, 4).view());
    for (const float side : {1.0F, -1.0F}) {
        for (const float height : {0.05F, 0.2F, 0.22F}) {
            ContactList contacts;
            sphereContacts(sheet, {{0.1F, side * height, 0.03F}, 0.2F}, reach, {}, contacts);
            ASSERT_EQ(contacts.size(), 1U);
            EXPECT_NEAR(contacts[0].signedDistance, height - 0.2F, 1e-6F);
            EXPECT_LT((contacts[0].normal + side * Vector3f::UnitY()).norm(), 1e-6F);
        }
    }
}

// Capsule

double leastOnAxis(const Body& body, const CapsuleSolid& capsule) {
    double least = 1e9;
    for (int i = 0; i <= 600; ++i) {
        const Vector3d x = capsule.from.cast<double>() + i / 600.0 * (capsule.to - capsule.from).cast<double>();
        least = std::min(least, body.truth.signedDistance(x));
    }
    return least;
}

TEST(CapsuleContacts, TheDeepestIsTheAxisSignedDistance) {
    test::Random random(3);
    for (const Body& body : bodies()) {
        int compared = 0;
        for (std::size_t i = 0; i < test::sampleSize(100, 3000); ++i) {
            CapsuleSolid capsule;
            capsule.from = inflatedPoint(body.model, random, 0.5F);
            capsule.to = capsule.from + static_cast<float>(random.uniform(0.1, 0.8)) * random.direction();
            const double axis = leastOnAxis(body, capsule);
            // Let it touch shallowly, from outside.
            if (axis < 0.02) {
                continue;
            }
            capsule.radius = static_cast<float>(std::max(0.0, axis + random.uniform(-0.1, 0.02)));
            ContactList contacts;
            capsuleContacts(body.model, capsule, reach, {}, contacts);
            const double truth = axis - capsule.radius;
            const std::string where = std::string(body.name) + ", sample " + std::to_string(i) + ": ";
            expectConsistent(body, contacts, where);
            if (truth > reach) {
                EXPECT_TRUE(contacts.empty() || test::deepest(contacts)->signedDistance > reach - 1e-3F) << where;
                continue;
            }
            if (truth > reach - 1e-3) {
                continue;
            }
            ++compared;
            ASSERT_FALSE(contacts.empty()) << where << truth;
            EXPECT_NEAR(test::deepest(contacts)->signedDistance, truth, 2e-4)
                << where << testing::PrintToString(contacts) << capsule.from.transpose() << " to "
                << capsule.to.transpose() << " r " << capsule.radius;
        }
        EXPECT_GT(compared, 15) << body.name;
    }
}

TEST(CapsuleContacts, LyingOnAFloorItTouchesAtBothEnds) {
    for (const MeshModel& floor : {makeModel(scenes::grid(2, 2, 5, 5).view()),
                                   makeModel(scenes::moved(scenes::box({2, 0.5F, 2}, 3), {0, -0.5F, 0}).view())}) {
        for (const float tilt : {0.0F, 0.03F}) {
            for (const float gap : {0.02F, -0.01F}) {
                const float lift = 0.2F + gap;
                const CapsuleSolid capsule{{-0.5F, lift, 0.11F}, {0.5F, lift + tilt, 0.23F}, 0.2F};
                ContactList contacts;
                capsuleContacts(floor, capsule, reach, {}, contacts);
                ASSERT_EQ(contacts.size(), 2U) << gap << ' ' << tilt;
                for (const SurfaceContact& contact : contacts) {
                    EXPECT_LT((contact.normal + Vector3f::UnitY()).norm(), 1e-6F);
                    EXPECT_NEAR(contact.signedDistance, gap + (contact.onA.x() > 0 ? tilt : 0), 1e-5F);
                }
            }
        }
    }
}

TEST(CapsuleContacts, AcrossABarItTouchesBothRims) {
    const MeshModel bar = makeModel(scenes::box({0.1F, 0.1F, 1}).view());
    ContactList contacts;
    capsuleContacts(bar, {{-0.6F, 0.19F, 0}, {0.6F, 0.19F, 0.2F}, 0.1F}, reach, {}, contacts);
    EXPECT_EQ(contacts.size(), 2U);
    for (const SurfaceContact& contact : contacts) {
        EXPECT_NEAR(contact.signedDistance, -0.01F, 1e-5F);
        EXPECT_NEAR(std::abs(contact.onA.x()), 0.1F, 1e-5F);
        EXPECT_LT(contact.normal.y(), -0.9999F);
    }
    // The axis itself below the bar's top: still out at the top.
    contacts.clear();
    capsuleContacts(bar, {{-0.6F, 0.08F, 0}, {0.6F, 0.08F, 0.2F}, 0.1F}, reach, {}, contacts);
    ASSERT_NE(test::deepest(contacts), nullptr);
    EXPECT_NEAR(test::deepest(contacts)->signedDistance, -0.12F, 1e-5F);
    EXPECT_LT(test::deepest(contacts)->normal.y(), -0.999F);
}

TEST(CapsuleContacts, WithoutLengthItIsASphere) {
    const Body& cup = bodies()[3];
    test::Random random(4);
    for (int i = 0; i < 30; ++i) {
        const Vector3f center = inflatedPoint(cup.model, random, 0.2F);
        ContactList sphere;
        ContactList capsule;
        sphereContacts(cup.model, {center, 0.1F}, reach, {}, sphere);
        capsuleContacts(cup.model, {center, center, 0.1F}, reach, {}, capsule);
        ASSERT_EQ(sphere.size(), capsule.size());
        for (std::size_t c = 0; c < sphere.size(); ++c) {
            EXPECT_EQ(sphere[c].onA, capsule[c].onA);
            EXPECT_EQ(sphere[c].signedDistance, capsule[c].signedDistance);
        }
    }
}

// Box

TEST(BoxContacts, AreThoseOfTheBoxesMesh) {
    test::Random random(5);
    std::size_t seen = 0;
    std::size_t missing = 0;
    std::size_t extra = 0;
    std::size_t poses = 0;
    std::size_t onlyOneTouches = 0;
    for (const Body& body : bodies()) {
        for (std::size_t i = 0; i < test::sampleSize(60, 2000); ++i) {
            BoxSolid box;
            box.half = Vector3f(0.2F, 0.3F, 0.15F);
            const scenes::Mesh boxMesh = scenes::box(box.half);
            const MeshModel boxModel = makeModel(boxMesh.view());
            box.pose = {random.rotation(), Vector3f::Zero()};
            // Shallow: slide in until a corner of either is as deep as wanted.
            const Vector3f direction = random.direction();
            const double wanted = random.uniform(0.0, 0.02);
            const scenes::TrueSurface boxTruth(boxMesh.view());
            const scenes::PoseD at{box.pose.rotation.cast<double>(), Vector3d::Zero()};
            float t = 1.6F;
            for (; t > 0; t -= 0.01F) {
                scenes::PoseD pose = at;
                pose.translation = (t * direction).cast<double>();
                if (scenes::truePenetration(body.truth, {}, boxTruth, pose) > wanted) {
                    break;
                }
            }
            box.pose.translation = (t + static_cast<float>(random.uniform(0.0, 0.05))) * direction;
            ContactList analytic;
            boxContacts(body.model, box, 0.05F, {}, analytic);
            const ContactList meshes = test::localContactsOf(body.model, boxModel, box.pose, 0.05F);
            const std::string where = std::string(body.name) + ", sample " + std::to_string(i) + ": ";
            expectConsistent(body, analytic, where, detail::canReachThrough(body.model, box));
            const auto has = [](const ContactList& list, const SurfaceContact& contact) {
                return std::any_of(list.begin(), list.end(), [&](const SurfaceContact& other) {
                    return (other.onA - contact.onA).norm() < 1e-3F && other.normal.dot(contact.normal) > 0.999F &&
                           std::abs(other.signedDistance - contact.signedDistance) < 1e-4F;
                });
            };
            for (const SurfaceContact& contact : meshes) {
                ++seen;
                missing += has(analytic, contact) ? 0 : 1;
            }
            for (const SurfaceContact& contact : analytic) {
                extra += has(meshes, contact) ? 0 : 1;
            }
            const SurfaceContact* deepestMesh = test::deepest(meshes);
            const SurfaceContact* deepest = test::deepest(analytic);
            ++poses;
            onlyOneTouches += (deepestMesh == nullptr) != (deepest == nullptr) ? 1 : 0;
        }
    }
    EXPECT_GT(seen, 500U);
    // Crossed edges deeper than the search distance may be all there is.
    EXPECT_LE(onlyOneTouches, poses / 500);
    // They differ in which way out of several a deep corner takes.
    EXPECT_LT(missing, seen / 10);
    EXPECT_LT(extra, seen / 10);
    RecordProperty("missing", static_cast<int>(missing));
    RecordProperty("extra", static_cast<int>(extra));
}

TEST(BoxContacts, ABodyThatGoesRightThroughAThinWallIsPushedOut) {
    const MeshModel ball = makeModel(scenes::bumpySphere(0.2F, 0.03F, 5, 5).view());
    const scenes::TrueSurface ballTruth(scenes::bumpySphere(0.2F, 0.03F, 5, 5).view());
    const Vector3f half(0.004F, 2, 2);  // thinner than the ball's triangles
    const scenes::TrueSurface wallTruth(scenes::box(half).view());
    int through = 0;
    for (float x = -0.16F; x <= 0.16F; x += 0.01F) {
        BoxSolid wall;
        wall.half = half;
        wall.pose.translation = Vector3f(x, 0.1F, 0.05F);
        ContactList contacts;
        boxContacts(ball, wall, 0.01F, {}, contacts);
        const scenes::PoseD pose{Eigen::Matrix3d::Identity(), wall.pose.translation.cast<double>()};
        const double depth = scenes::truePenetration(ballTruth, {}, wallTruth, pose);
        if (depth > 1e-3) {
            ++through;
            ASSERT_FALSE(contacts.empty()) << x;
            EXPECT_LT(test::deepest(contacts)->signedDistance, 0) << x;
            if (std::abs(x) > 0.03F) {  // else both sides are equally near
                EXPECT_LT(test::deepest(contacts)->normal.x() * x, -0.7F * std::abs(x)) << x;
            }
        }
    }
    EXPECT_GT(through, 20);
}

TEST(BoxContacts, ABodyOverOrInAThickFloorIsPushedUp) {
    const Vector3f half(5, 1, 5);
    test::Random random(6);
    for (const Body& body : bodies()) {
        for (const float depth : {-0.03F, 0.002F, 0.03F, 0.2F, 0.4F}) {
            for (int i = 0; i < 8; ++i) {
                const Matrix3f turn = random.rotation();
                float lowest = 1e9F;
                for (const Vector3f& vertex : body.model.tree.vertices) {
                    lowest = std::min(lowest, (turn * vertex).y());
                }
                const Pose bodyInBox{turn, Vector3f(static_cast<float>(random.uniform(-3, 3)), 1 - lowest - depth,
                                                    static_cast<float>(random.uniform(-3, 3)))};
                ContactList contacts;
                boxContacts(body.model, {inverse(bodyInBox), half}, reach, {}, contacts);
                const std::string where = std::string(body.name) + ", depth " + std::to_string(depth) + ": ";
                ASSERT_FALSE(contacts.empty()) << where;
                EXPECT_NEAR(test::deepest(contacts)->signedDistance, -depth, 1e-4F) << where;
                for (const SurfaceContact& contact : contacts) {
                    EXPECT_GT((turn * contact.normal).y(), 1 - 1e-5F) << where << testing::PrintToString(contact);
                }
            }
        }
    }
}

TEST(BoxContacts, ABlockOnAnEqualBoxTouchesInTheWholeOverlap) {
    const Vector3f half = Vector3f::Constant(0.5F);
    const MeshModel block = makeModel(scenes::box(half).view());
    for (const float gap : {0.03F, 0.001F, -0.002F}) {
        for (const Vector3f& offset : {Vector3f(0, 0, 0), Vector3f(1e-5F, 0, 0), Vector3f(0.3F, 0, 0.2F)}) {
            ContactList contacts;
            boxContacts(block, {{Matrix3f::Identity(), Vector3f(0, -1 - gap, 0) - offset}, half}, reach, {}, contacts);
            const Vector3f low = (-half).cwiseMax(-half - offset);
            const Vector3f high = half.cwiseMin(half - offset);
            for (int corner = 0; corner < 4; ++corner) {
                const Vector3f onA(corner % 2 == 0 ? low.x() : high.x(), -half.y(),
                                   corner / 2 == 0 ? low.z() : high.z());
                EXPECT_TRUE(
                    std::any_of(contacts.begin(), contacts.end(),
                                [&](const SurfaceContact& contact) { return (contact.onA - onA).norm() < 2e-4F; }))
                    << gap << ", offset " << offset.transpose() << ", at " << onA.transpose();
            }
            for (const SurfaceContact& contact : contacts) {
                EXPECT_GT(contact.normal.y(), 1 - 1e-5F) << gap << testing::PrintToString(contact);
                EXPECT_NEAR(contact.signedDistance, gap, 1e-4F) << gap << testing::PrintToString(contact);
            }
        }
    }
}

// A U hung over a bar: the bar touches it from within; no leg is pushed through the bar.
TEST(BoxContacts, AUOnABarHangsOnItsInnerSide) {
    const MeshModel u = makeModel(scenes::uBody(1, 1, 0.2F, 0.4F).view());
    ASSERT_TRUE(u.solid);
    const float innerTop = u.tree.upper.y() - 0.2F;
    const float middle = (u.tree.lower.x() + u.tree.upper.x()) / 2;
    const float depth = (u.tree.lower.z() + u.tree.upper.z()) / 2;
    for (const float gap : {0.01F, -0.005F}) {
        const Vector3f half(0.2F, 0.2F, 2);
        ContactList contacts;
        boxContacts(u, {{Matrix3f::Identity(), Vector3f(middle, innerTop - 0.2F - gap, depth)}, half}, reach, {},
                    contacts);
        ASSERT_GE(contacts.size(), 4U) << gap;
        for (const SurfaceContact& contact : contacts) {
            EXPECT_GT(contact.normal.y(), 1 - 1e-5F) << gap << testing::PrintToString(contact);
            EXPECT_NEAR(contact.signedDistance, gap, 1e-5F) << gap << testing::PrintToString(contact);
        }
    }
}

// Tessellated bodies against the formula, by every way there is.
TEST(ConvexContacts, TessellatedBodiesFollowTheFormula) {
    const float radius = 0.5F;
    const int frequency = 12;
    const MeshModel ball = makeModel(scenes::sphere(radius, frequency).view());
    const MeshModel floor = makeModel(scenes::grid(2, 2, 6, 6).view());
    const float sagitta = 0.004F * radius;  // of the coarsest triangle, see the frequency
    test::Random random(7);
    for (int i = 0; i < 40; ++i) {
        const Matrix3f turn = random.rotation();
        const float gap = static_cast<float>(random.uniform(-0.02, 0.04));
        const Pose ballInWorld{turn, Vector3f(0.1F, radius + gap, 0.2F)};
        const Vector3f up = turn.transpose() * Vector3f::UnitY();
        const auto expectGap = [&](const ContactList& contacts, const Vector3f& normal, const char* way) {
            const SurfaceContact* contact = test::deepest(contacts);
            ASSERT_NE(contact, nullptr) << way;
            EXPECT_NEAR(contact->signedDistance, gap, sagitta) << way;
            EXPECT_GT(contact->normal.dot(normal), 0.999F) << way;
        };
        ContactList plane;
        planeContacts(ball, {up, -(radius + gap)}, reach, {}, plane);
        expectGap(plane, up, "plane");
        ContactList box;
        const Pose boxInBall = compose(inverse(ballInWorld), {Matrix3f::Identity(), Vector3f(0, -1, 0)});
        boxContacts(ball, {boxInBall, {3, 1, 3}}, reach, {}, box);
        expectGap(box, up, "box");
        expectGap(test::localContactsOf(ball, floor, inverse(ballInWorld), reach), up, "mesh");
        ContactList sphere;
        sphereContacts(ball, {(radius + gap + 0.3F) * random.direction(), 0.3F}, reach, {}, sphere);
        ASSERT_FALSE(sphere.empty());
        EXPECT_NEAR(test::deepest(sphere)->signedDistance, gap, sagitta);
        ContactList capsule;
        const Vector3f across = up.unitOrthogonal();
        const Vector3f below = -(radius + gap + 0.1F) * up;
        capsuleContacts(ball, {below - across, below + across, 0.1F}, reach, {}, capsule);
        expectGap(capsule, up, "capsule");
    }
}

TEST(ConvexContacts, IsLocalExtremumKnowsCornersEdgesAndFaces) {
    const scenes::Mesh cube = scenes::box(Vector3f::Ones());
    const MeshModel model = makeModel(cube.view());
    const LocalContactSettings settings;
    for (std::uint32_t t = 0; t < cube.triangles.size(); ++t) {
        const Vector3f& face = model.triangleNormals[t];
        EXPECT_TRUE(isLocalExtremum(model, t, 6, face, settings));
        EXPECT_FALSE(isLocalExtremum(model, t, 6, -face, settings));
        for (unsigned c = 0; c < 3; ++c) {
            const Vector3f corner = cube.vertices[cube.triangles[t][c]];
            EXPECT_TRUE(isLocalExtremum(model, t, static_cast<int>(c), corner.normalized(), settings));
            EXPECT_TRUE(isLocalExtremum(model, t, static_cast<int>(c), face, settings));
            EXPECT_FALSE(isLocalExtremum(model, t, static_cast<int>(c), -corner.normalized(), settings));
            EXPECT_FALSE(isLocalExtremum(model, t, static_cast<int>(c),
                                         (corner - 2 * corner.cwiseProduct(face.cwiseAbs())).normalized(), settings));
            const Vector3f next = cube.vertices[cube.triangles[t][(c + 1) % 3]];
            const Vector3f middle = (corner + next) / 2;
            if ((middle.cwiseAbs().array() > 0.999F).count() == 2) {
                EXPECT_TRUE(isLocalExtremum(model, t, static_cast<int>(c) + 3, middle.normalized(), settings));
                EXPECT_FALSE(isLocalExtremum(model, t, static_cast<int>(c) + 3, -middle.normalized(), settings));
            }
        }
    }
}

}  // namespace
}  // namespace grapeshot
