// Every pair of shapes that a scene can have: who serves it, and whether the contacts are right.
//
// The truth is a support function of the upper shape over flat ground: how deep its lowest point is, whatever the kind
// of the ground, whatever the order of the bodies, wherever the scene stands and however it is turned.
#include <BulletCollision/Gimpact/btGImpactCollisionAlgorithm.h>
#include <gmock/gmock.h>

#include <algorithm>

#include <grapeshot/plugin/detail/compound_algorithm.hpp>

#include "own_concave_shape.hpp"
#include "shape_zoo.hpp"

namespace grapeshot::test {
namespace {

constexpr btScalar pairMargin = 0.01_s;

/// A pose for which nothing is parallel to anything.
btTransform somewhere() {
    return at({1, -2, 3}, btQuaternion({0.3_s, 0.5_s, 0.8_s}, 1.1_s));
}

struct Point {
    btScalar distance;
    btVector3 normal;  ///< on the ground, out of it
    btVector3 onGround;
    int part, index;  ///< of the ground
};

/// The two bodies for one moment, in either order.
struct Meeting {
    Meeting(const Settings& settings, const ZooShape& upper, const btTransform& upperPose, const ZooShape& ground,
            const btTransform& groundPose, bool upperFirst)
        : world(settings) {
        btRigidBody* first = upperFirst ? &world.add(*upper.shape, upperPose, 1, {1, 1, 1}) : nullptr;
        world.add(*ground.shape, groundPose);
        btRigidBody& body = first != nullptr ? *first : world.add(*upper.shape, upperPose, 1, {1, 1, 1});
        world.world.performDiscreteCollisionDetection();
        for (int m = 0; m < world.dispatcher.getNumManifolds(); ++m) {
            const btPersistentManifold& manifold = *world.dispatcher.getManifoldByIndexInternal(m);
            const bool upperIs0 = manifold.getBody0() == &body;
            for (int i = 0; i < manifold.getNumContacts(); ++i) {
                const btManifoldPoint& p = manifold.getContactPoint(i);
                points.push_back({p.getDistance(), upperIs0 ? p.m_normalWorldOnB : -p.m_normalWorldOnB,
                                  upperIs0 ? p.m_positionWorldOnB : p.m_positionWorldOnA,
                                  upperIs0 ? p.m_partId1 : p.m_partId0, upperIs0 ? p.m_index1 : p.m_index0});
            }
        }
    }
    [[nodiscard]] const Point& deepest() const {
        return *std::min_element(points.begin(), points.end(),
                                 [](const Point& x, const Point& y) { return x.distance < y.distance; });
    }
    TestWorld world;
    std::vector<Point> points;
};

/// Lets `upper` hang `gap` over the ground (y = 0 plus its margin in the ground's frame) and looks at what is found.
void expectRight(const Settings& settings, const ZooShape& upper, const btQuaternion& turn, btScalar gap,
                 const ZooShape& ground, btScalar groundMargin) {
    SCOPED_TRACE(upper.name + " on " + ground.name + ", gap " + std::to_string(gap));
    const btTransform place = somewhere();
    const btVector3 up = place.getBasis().getColumn(1);
    btTransform inGround = at({0.13_s, 0, 0.21_s}, turn);
    const btVector3 lowest = inGround * upper.support(inGround.getBasis().transpose() * btVector3(0, -1, 0));
    inGround.getOrigin().setY(gap + groundMargin - lowest.y());
    std::array<Point, 2> found;
    for (const bool upperFirst : {true, false}) {
        const Meeting meeting(settings, upper, place * inGround, ground, place, upperFirst);
        ASSERT_FALSE(meeting.points.empty()) << "upper first: " << upperFirst;
        const Point& deepest = found[upperFirst ? 0 : 1] = meeting.deepest();
        EXPECT_NEAR(deepest.distance, gap, 2e-3);
        EXPECT_GT(deepest.normal.dot(up), 0.998);
        // What cuts a sheet may be placed amid the two surfaces.
        const btScalar amid = ground.solid ? 0.0_s : btMax(0.0_s, groundMargin - gap) / 2;
        EXPECT_NEAR((place.inverse() * deepest.onGround).y(), groundMargin, 2e-3_s + amid);
        for (const Point& point : meeting.points) {
            EXPECT_GT(point.normal.dot(up), 0.99);
        }
        EXPECT_EQ(meeting.world.stats().fallbacks, 0U);
        EXPECT_EQ(meeting.world.stats().refused, 0);
    }
    EXPECT_NEAR(found[0].distance, found[1].distance, 1e-4) << "the order matters";
    EXPECT_LT(found[0].normal.distance(found[1].normal), 1e-3) << "the order matters";
}

const std::array<btQuaternion, 3> turns{btQuaternion::getIdentity(), btQuaternion({0.6_s, 0, 0.8_s}, 0.7_s),
                                        btQuaternion({0.2_s, 0.7_s, -0.5_s}, 2.3_s)};

class EveryPair : public testing::TestWithParam<Concave> {};

/// Bullet's own recursion culls with the children's bare boxes, and its boxes touch boxes only when they overlap: what
/// ends there has no contacts ahead of the touch.
constexpr std::array gaps{0.006_s, -0.006_s, -0.03_s};
constexpr std::array gapsInCompounds{-0.024_s, -0.04_s};

/// A sheet pushes with its outer side, which of a height field is the upper one: it comes upside down, and not on edge.
void hang(const Settings& settings, ShapeZoo& zoo, Concave kind, const ZooShape& body, const ZooShape& ground,
          btScalar groundMargin) {
    const bool field = kind == Concave::heightField;
    const btQuaternion over = field ? btQuaternion({1, 0, 0}, SIMD_PI) : btQuaternion::getIdentity();
    const ZooShape child = zoo.inCompound(body, at({0.2_s, 0.1_s, 0}, field ? turns[1] : turns[2]));
    for (std::size_t i = 0; i < (field ? 2U : 3U); ++i) {
        for (const btScalar gap : gaps) {
            const bool sheets = !body.solid && !ground.solid;  // between two there is no inside
            if ((gap > 0 || !sheets) && (gap < 0 || kind != Concave::gimpactCompound)) {
                expectRight(settings, body, turns[i] * over, gap, ground, groundMargin);
            }
        }
        for (const btScalar gap : gapsInCompounds) {
            if (i == 0 && (body.solid || ground.solid)) {
                expectRight(settings, child, turns[i] * over, gap, ground, groundMargin);
            }
        }
    }
}

TEST_P(EveryPair, ConcaveOnConcave) {
    ShapeZoo zoo;
    Settings settings;
    settings.bvhConvexPairs = true;  // for the children of a GImpact compound
    const ZooShape ground = zoo.floor(GetParam(), pairMargin);
    const btScalar groundMargin = GetParam() == Concave::gimpactCompound ? 0.0_s : pairMargin;
    for (const Concave kind : allConcave) {
        hang(settings, zoo, kind, zoo.body(kind, pairMargin), ground, groundMargin);
    }
}

TEST_P(EveryPair, ConcaveOnAPlane) {
    ShapeZoo zoo;
    const ZooShape ground{"plane", zoo.keep<btStaticPlaneShape>(btVector3(0, 1, 0), 0.0_s), {}};
    hang({}, zoo, GetParam(), zoo.body(GetParam(), pairMargin), ground, ground.shape->getMargin());
}

TEST_P(EveryPair, ConvexOnConcave) {
    ShapeZoo zoo;
    Settings settings;
    settings.bvhConvexPairs = true;
    const ZooShape ground = zoo.floor(GetParam(), pairMargin);
    const bool compound = GetParam() == Concave::gimpactCompound;
    for (const ZooShape& convex : zoo.convex()) {
        const ZooShape child = zoo.inCompound(convex, at({0.2_s, 0.1_s, 0}, turns[2]));
        for (const btQuaternion& turn : turns) {
            for (const btScalar gap : gaps) {
                if (gap < 0 || !compound) {
                    expectRight(settings, convex, turn, gap, ground, compound ? 0.0_s : pairMargin);
                }
            }
            for (const btScalar gap : gapsInCompounds) {
                expectRight(settings, child, turn, gap, ground, compound ? 0.0_s : pairMargin);
            }
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Kinds, EveryPair, testing::ValuesIn(allConcave),
                         [](const auto& sample) { return nameOf(sample.param); });

// Who serves what.

enum class Server { ours, children, bullet, nobody };

Server serverOf(TestWorld& world, btCollisionShape& first, btCollisionShape& second, ebtDispatcherQueryType query) {
    btCollisionObject objects[2];
    objects[0].setCollisionShape(&first);
    objects[1].setCollisionShape(&second);
    const btCollisionObjectWrapper a(nullptr, &first, &objects[0], objects[0].getWorldTransform(), -1, -1);
    const btCollisionObjectWrapper b(nullptr, &second, &objects[1], objects[1].getWorldTransform(), -1, -1);
    btCollisionAlgorithm* made = world.dispatcher.findAlgorithm(&a, &b, nullptr, query);
    const Server server = dynamic_cast<AdbCollisionAlgorithm*>(made) != nullptr       ? Server::ours
                          : dynamic_cast<detail::CompoundAlgorithm*>(made) != nullptr ? Server::children
                          : dynamic_cast<btEmptyAlgorithm*>(made) != nullptr          ? Server::nobody
                                                                                      : Server::bullet;
    made->~btCollisionAlgorithm();
    world.dispatcher.freeCollisionAlgorithm(made);
    return server;
}

bool isGImpactMesh(Concave kind) {
    return kind == Concave::mesh || kind == Concave::part;
}

TEST(WhoServes, EveryPairInBothOrdersAndTables) {
    ShapeZoo zoo;
    std::vector<ZooShape> concave;
    for (const Concave kind : allConcave) {
        concave.push_back(zoo.body(kind, pairMargin));
    }
    const std::vector<ZooShape> convex = zoo.convex();
    btStaticPlaneShape plane({0, 1, 0}, 0);
    btEmptyShape empty;
    OwnConcaveShape own;
    for (const bool takeAll : {false, true}) {
        Settings settings;
        settings.bvhConvexPairs = takeAll;
        TestWorld world(settings);
        const auto expectServer = [&](Server server, btCollisionShape& first, btCollisionShape& second) {
            for (const auto query : {BT_CONTACT_POINT_ALGORITHMS, BT_CLOSEST_POINT_ALGORITHMS}) {
                EXPECT_EQ(serverOf(world, first, second, query), server) << first.getName() << ' ' << second.getName();
                EXPECT_EQ(serverOf(world, second, first, query), server) << second.getName() << ' ' << first.getName();
            }
        };
        for (std::size_t i = 0; i < concave.size(); ++i) {
            const bool compound = allConcave[i] == Concave::gimpactCompound;
            btCollisionShape& shape = *concave[i].shape;
            for (std::size_t j = 0; j < concave.size(); ++j) {
                const bool either = compound || allConcave[j] == Concave::gimpactCompound;
                // A GImpact compound among meshes that are none of GImpact's has a place of GImpact's as well.
                expectServer(either ? Server::children : Server::ours, shape, *concave[j].shape);
            }
            for (const ZooShape& solid : convex) {
                const Server bvh = takeAll ? Server::ours : Server::bullet;
                expectServer(compound                       ? Server::children
                             : isGImpactMesh(allConcave[i]) ? Server::ours
                                                            : bvh,
                             shape, *solid.shape);
            }
            expectServer(compound ? Server::children : Server::ours, shape, plane);
            expectServer(Server::nobody, shape, empty);
        }
        EXPECT_EQ(world.stats().fallbacks, 0U);
        expectServer(Server::nobody, plane, plane);
        expectServer(Server::nobody, empty, empty);
        expectServer(Server::nobody, own, *zoo.body(Concave::bvh, pairMargin).shape);
        expectServer(Server::nobody, own, plane);
        EXPECT_EQ(world.stats().fallbacks, 0U);
        expectServer(Server::bullet, own, *zoo.body(Concave::mesh, pairMargin).shape);
        EXPECT_EQ(world.stats().fallbacks, 4U);
        for (const ZooShape& solid : convex) {
            expectServer(Server::bullet, *solid.shape, *convex[0].shape);
            expectServer(Server::bullet, *solid.shape, plane);
        }
    }
}

TEST(WhoServes, AfterGImpactItIsTheSame) {
    ShapeZoo zoo;
    TestWorld world({}, false);
    btGImpactCollisionAlgorithm::registerAlgorithm(&world.dispatcher);
    ASSERT_EQ(registerAlgorithms(&world.dispatcher), Status::ok);
    btStaticPlaneShape plane({0, 1, 0}, 0);
    for (const Concave kind : allConcave) {
        btCollisionShape& shape = *zoo.body(kind, pairMargin).shape;
        btCollisionShape& mesh = *zoo.body(Concave::mesh, pairMargin).shape;
        const bool compound = kind == Concave::gimpactCompound;
        EXPECT_EQ(serverOf(world, mesh, shape, BT_CONTACT_POINT_ALGORITHMS),
                  compound ? Server::children : Server::ours);
        EXPECT_EQ(serverOf(world, shape, plane, BT_CONTACT_POINT_ALGORITHMS),
                  compound ? Server::children : Server::ours);
    }
    EXPECT_EQ(world.stats().fallbacks, 0U);
}

}  // namespace
}  // namespace grapeshot::test
