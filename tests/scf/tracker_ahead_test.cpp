// Looking ahead: what will touch is known before it does.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include <grapeshot/scf/tracker.hpp>

#include <scf/tracked_scenes.hpp>
#include <support/oracle.hpp>

namespace grapeshot::test {
namespace {

/// B comes straight at A, faster or slower, in so many steps.
SurfaceState aheadB(const TwoBumpy& scene, std::vector<Eigen::Vector3f>& positions, int step) {
    positions = scene.meshB.vertices;
    for (Eigen::Vector3f& vertex : positions) {
        vertex += Eigen::Vector3f(2.05F - 0.012F * static_cast<float>(step), 0.1F, -0.2F);
    }
    SurfaceState state{positions, {}, Stretch::given(1), {}};
    state.displacement = Displacement::given(0.012F);
    return state;
}

TEST(LookAhead, PairsAheadAreNearAndNotInContact) {
    const TwoBumpy scene(20);
    TrackSettings settings = TwoBumpy::settings(TrackMode::budget);
    settings.maxDistance = 0.004F;
    settings.lookAhead = 2;
    Tracker tracker(scene.a, scene.b);
    std::vector<Eigen::Vector3f> positions;
    std::size_t ahead = 0;
    std::set<std::pair<std::uint32_t, std::uint32_t>> known;  // ahead in the step before
    std::size_t came = 0;
    for (int step = 0; step < 30; ++step) {
        const SurfaceState b = aheadB(scene, positions, step);
        const TrackResult result = tracker.step(rigidState(), b, settings, {.work = 1500});
        const MeshView mesh{positions, scene.meshB.triangles};
        for (const TrackedContact& contact : result.ahead) {
            const double distance = triangleDistance(cornersOf(scene.meshA.view(), contact.pair.triangleA),
                                                     cornersOf(mesh, contact.pair.triangleB));
            EXPECT_NEAR(contact.signedDistance, distance, 2e-6);
            EXPECT_GT(distance, 0.004 - 2e-6);
            EXPECT_LE(distance, 0.004 + 2 * static_cast<double>(result.nearer) + 2e-6);
            EXPECT_FALSE(contact.overlapping);
        }
        for (const TrackedContact& contact : result.contacts) {
            came += known.count({contact.pair.triangleA, contact.pair.triangleB});
        }
        known.clear();
        for (const TrackedContact& contact : result.ahead) {
            known.emplace(contact.pair.triangleA, contact.pair.triangleB);
        }
        ahead += result.ahead.size();
    }
    EXPECT_GT(ahead, 30U);
    EXPECT_GT(came, 5U);
}

TEST(LookAhead, MoreIsKnownWhenItBegins) {
    const TwoBumpy scene(28);
    std::size_t found[2] = {};
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
        for (const bool looks : {false, true}) {
            TrackSettings settings = TwoBumpy::settings(TrackMode::budget);
            settings.maxDistance = 0.002F;
            settings.seed = seed;
            settings.lookAhead = looks ? 3.0F : 0.0F;
            Tracker tracker(scene.a, scene.b);
            std::vector<Eigen::Vector3f> positions;
            for (int step = 0; step < 30; ++step) {
                found[looks ? 1 : 0] +=
                    tracker.step(rigidState(), aheadB(scene, positions, step), settings, {.work = 250}).contacts.size();
            }
        }
    }
    EXPECT_GT(found[0], 200U);
    EXPECT_GT(found[1], found[0] * 105 / 100);
}

TEST(LookAhead, WithoutItDisplacementsChangeNothing) {
    const TwoBumpy scene(16);
    TrackSettings settings = TwoBumpy::settings(TrackMode::budget);
    settings.keepFront = false;
    Tracker told(scene.a, scene.b);
    Tracker untold(scene.a, scene.b);
    std::vector<Eigen::Vector3f> positions;
    for (int step = 10; step < 24; ++step) {
        SurfaceState b = aheadB(scene, positions, step);
        const TrackResult one = told.step(rigidState(), b, settings, {.work = 900});
        b.displacement = {};
        EXPECT_EQ(bytesOf(one), bytesOf(untold.step(rigidState(), b, settings, {.work = 900})));
        EXPECT_TRUE(one.ahead.empty());
    }
    EXPECT_EQ(told.save(), untold.save());
}

}  // namespace
}  // namespace grapeshot::test
