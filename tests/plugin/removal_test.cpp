// Bodies and constraints that go while a callback of Bullet's is on its way: registered alone, and under a budget.
#include <functional>
#include <string>
#include <utility>

#include "bullet_fixture.hpp"

namespace grapeshot::test {
namespace {

enum class Hook { added, processed, destroyed, started, ended, nearBefore, nearAfter };
constexpr std::array allHooks{Hook::added, Hook::processed,  Hook::destroyed, Hook::started,
                              Hook::ended, Hook::nearBefore, Hook::nearAfter};
constexpr std::array hookNames{"added", "processed", "destroyed", "started", "ended", "nearBefore", "nearAfter"};

enum class Gone { first, second, third, constraint };
constexpr std::array allGone{Gone::first, Gone::second, Gone::third, Gone::constraint};

/// What the callbacks do, once, when a contact or pair of the watched body comes by.
struct Removal {
    std::function<void()> act;
    const btCollisionObject* watched = nullptr;
    int done = 0;
    int userData = 0;  // something for points to hold on to

    void happens(const void* first, const void* second) {
        if (act && (first == watched || second == watched)) {
            ++done;
            std::exchange(act, nullptr)();
        }
    }
};
Removal removal;

/// As many callbacks as Bullet has; all are given back.
class Hooks {
  public:
    Hooks(Hook hook, btCollisionDispatcher& dispatcher) {
        gContactAddedCallback = [](btManifoldPoint& point, const btCollisionObjectWrapper* first, int, int,
                                   const btCollisionObjectWrapper* second, int, int) {
            point.m_userPersistentData = &removal.userData;
            if (current == Hook::added) {
                removal.happens(first->getCollisionObject(), second->getCollisionObject());
            }
            return true;
        };
        gContactProcessedCallback = [](btManifoldPoint&, void* first, void* second) {
            if (current == Hook::processed) {
                removal.happens(first, second);
            }
            return true;
        };
        gContactDestroyedCallback = [](void*) {
            if (current == Hook::destroyed) {
                removal.happens(removal.watched, nullptr);
            }
            return true;
        };
        gContactStartedCallback = [](btPersistentManifold* const& manifold) {
            if (current == Hook::started) {
                removal.happens(manifold->getBody0(), manifold->getBody1());
            }
        };
        gContactEndedCallback = [](btPersistentManifold* const& manifold) {
            if (current == Hook::ended) {
                removal.happens(manifold->getBody0(), manifold->getBody1());
            }
        };
        current = hook;
        if (hook == Hook::nearBefore || hook == Hook::nearAfter) {
            dispatcher.setNearCallback(
                [](btBroadphasePair& pair, btCollisionDispatcher& to, const btDispatcherInfo& info) {
                    const void* first = pair.m_pProxy0->m_clientObject;
                    const void* second = pair.m_pProxy1->m_clientObject;
                    if (current == Hook::nearBefore && removal.act) {
                        removal.happens(first, second);
                        if (!removal.act) {
                            return;  // the pair may be gone, or another one be in its place
                        }
                    }
                    btCollisionDispatcher::defaultNearCallback(pair, to, info);
                    if (current == Hook::nearAfter) {
                        removal.happens(first, second);
                    }
                });
        }
    }
    ~Hooks() {
        gContactAddedCallback = nullptr;
        gContactProcessedCallback = nullptr;
        gContactDestroyedCallback = nullptr;
        gContactStartedCallback = nullptr;
        gContactEndedCallback = nullptr;
    }
    Hooks(const Hooks&) = delete;
    Hooks& operator=(const Hooks&) = delete;

  private:
    static inline Hook current = Hook::added;
};

/// Three towers of two on a floor; the watched body is the lower one of the first.
template <class World>
void removeIn(Hook hook, Gone gone, const Settings& settings) {
    const MeshShape floor(scenes::box({4, 0.5F, 2}, 6), Kind::bvh, 0.01_s);
    const MeshShape block(scenes::box({0.3F, 0.3F, 0.3F}, 3), Kind::mesh, 0.01_s);
    World world(settings);
    world.world.getDispatchInfo().m_deterministicOverlappingPairs = false;
    world.add(*floor, at({0, -0.5_s, 0}));
    for (int i = 0; i < 6; ++i) {
        btRigidBody& body =
            world.add(*block, at({1.5_s * btScalar(i / 2) - 1.5_s, 0.31_s + 0.62_s * btScalar(i % 2), 0}), 1);
        body.setCollisionFlags(body.getCollisionFlags() | btCollisionObject::CF_CUSTOM_MATERIAL_CALLBACK);
        body.setActivationState(DISABLE_DEACTIVATION);
    }
    btRigidBody& watched = *world.bodies[1];
    btPoint2PointConstraint constraint(watched, *world.bodies[3], {0.75_s, 0, 0}, {-0.75_s, 0, 0});
    world.world.addConstraint(&constraint);
    const Hooks hooks(hook, world.dispatcher);
    removal = {};
    removal.watched = &watched;
    world.step(hook == Hook::started || hook == Hook::nearBefore ? 0 : 3);
    btRigidBody* victim = gone == Gone::first    ? &watched
                          : gone == Gone::second ? world.bodies[2].get()
                          : gone == Gone::third  ? world.bodies[6].get()
                                                 : nullptr;
    const int objects = world.world.getNumCollisionObjects();
    removal.act = [&] {
        // Bullet wants the constraints of a body to go before it.
        world.world.removeConstraint(&constraint);
        if (victim != nullptr) {
            world.world.removeRigidBody(victim);
        }
    };
    if (hook == Hook::destroyed || hook == Hook::ended) {
        // The tower is pushed over, so that points go.
        world.bodies[2]->setLinearVelocity({0, 0, 2});
        watched.setLinearVelocity({0, 1, 3});
    }
    for (int i = 0; i < 60 && removal.done == 0; ++i) {
        world.step();
    }
    ASSERT_EQ(removal.done, 1);
    for (int m = 0; victim != nullptr && m < world.dispatcher.getNumManifolds(); ++m) {
        const btPersistentManifold& manifold = *world.dispatcher.getManifoldByIndexInternal(m);
        EXPECT_NE(manifold.getBody0(), victim);
        EXPECT_NE(manifold.getBody1(), victim);
    }
    EXPECT_EQ(world.world.getNumCollisionObjects(), objects - (victim != nullptr ? 1 : 0));
    EXPECT_EQ(world.world.getNumConstraints(), 0);
    world.step(60);
    for (const auto& body : world.bodies) {
        if (body->getInvMass() > 0 && body.get() != victim) {
            EXPECT_GT(body->getWorldTransform().getOrigin().y(), 0.25);
        }
    }
    EXPECT_GT(world.stats().contacts, 4) << "the others go on";
    if (victim != nullptr) {
        world.world.addRigidBody(victim);  // for the fixture, which takes it out again
        world.step(2);
    }
}

class RemovalIn : public testing::TestWithParam<Hook> {};

TEST_P(RemovalIn, RegisteredAlone) {
    for (const Gone gone : allGone) {
        SCOPED_TRACE(static_cast<int>(gone));
        removeIn<TestWorld>(GetParam(), gone, {});
    }
}

TEST_P(RemovalIn, UnderABudget) {
    for (const Gone gone : allGone) {
        for (const int threads : {1, 2}) {
            SCOPED_TRACE(std::to_string(static_cast<int>(gone)) + ", threads " + std::to_string(threads));
            Settings settings;
            settings.frameBudget.work = 400;
            settings.threads = threads;
            removeIn<BudgetWorld>(GetParam(), gone, settings);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(AllCallbacks, RemovalIn, testing::ValuesIn(allHooks),
                         [](const auto& hook) { return hookNames[static_cast<std::size_t>(hook.param)]; });

/// A third body while another is being removed by the program, outside of any step.
TEST(Removal, ADestroyedPointMayTakeAThirdBodyWithIt) {
    const MeshShape floor(scenes::box({4, 0.5F, 2}, 6), Kind::bvh, 0.01_s);
    const MeshShape block(scenes::box({0.3F, 0.3F, 0.3F}, 3), Kind::mesh, 0.01_s);
    TestWorld world;
    world.add(*floor, at({0, -0.5_s, 0}));
    for (int i = 0; i < 3; ++i) {
        btRigidBody& body = world.add(*block, at({btScalar(i) - 1, 0.31_s, 0}), 1);
        body.setCollisionFlags(body.getCollisionFlags() | btCollisionObject::CF_CUSTOM_MATERIAL_CALLBACK);
    }
    const Hooks hooks(Hook::destroyed, world.dispatcher);
    removal = {};
    world.step(3);
    removal.watched = world.bodies[1].get();
    removal.act = [&] { world.world.removeRigidBody(world.bodies[3].get()); };
    world.world.removeRigidBody(world.bodies[1].get());
    EXPECT_EQ(removal.done, 1);
    EXPECT_EQ(world.world.getNumCollisionObjects(), 2);
    world.step(10);
    EXPECT_GT(world.stats().contacts, 3);
    world.world.addRigidBody(world.bodies[1].get());
    world.world.addRigidBody(world.bodies[3].get());
    world.step(10);
    EXPECT_GE(world.points().size(), 12U);
}

}  // namespace
}  // namespace grapeshot::test
