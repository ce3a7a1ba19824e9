// Laws of the tracker: same bytes, swapped bodies, moved scenes, copies and saved states.
#include <gtest/gtest.h>

#include <algorithm>

#include <grapeshot/scf/tracker.hpp>

#include <adb/meshes.hpp>
#include <scf/tracked_scenes.hpp>
#include <support/fault_of.hpp>
#include <support/poses.hpp>

namespace grapeshot::test {
namespace {

/// With all that is remembered in use: slowly, its displacements measured, ahead of what comes.
TrackResult stepOf(Tracker& tracker, const TwoBumpy& scene, int frame, std::uint64_t work,
                   TrackMode mode = TrackMode::budget) {
    const TwoBumpy::Frame where = scene.at(16 + 0.2F * static_cast<float>(frame - 16));
    SurfaceState a = where.stateA();
    SurfaceState b = where.stateB();
    a.displacement = b.displacement = Displacement::measured();
    TrackSettings settings = TwoBumpy::settings(mode);
    settings.lookAhead = 1;
    return tracker.step(a, b, settings, {.work = work});
}

TEST(TrackerLaws, SameBytesOnEveryInstructionSetAndAgain) {
    const InstructionSetGuard guard;
    const TwoBumpy scene(16);
    for (const TrackMode mode : {TrackMode::exact, TrackMode::resolution, TrackMode::budget}) {
        std::vector<std::vector<std::byte>> first;
        for (int run = 0; run < 2; ++run) {
            for (const InstructionSet set : instructionSets()) {
                limitInstructionSet(set);
                Tracker tracker(scene.a, scene.b);
                std::vector<std::vector<std::byte>> all;
                std::size_t contacts = 0;
                std::size_t ahead = 0;
                std::uint32_t kept = 0;
                for (int frame = 10; frame < 22; ++frame) {
                    const TrackResult result = stepOf(tracker, scene, frame, 1500, mode);
                    contacts += result.contacts.size();
                    ahead += result.ahead.size();
                    kept += result.frontKept;
                    all.push_back(bytesOf(result));
                }
                all.push_back(tracker.save());
                first = first.empty() ? all : first;
                EXPECT_EQ(all, first);
                EXPECT_GT(contacts, 50U);
                EXPECT_GT(kept, 20U);
                EXPECT_EQ(ahead > 0, mode == TrackMode::budget);
            }
        }
    }
}

TEST(TrackerLaws, AnotherSeedIsAnotherSample) {
    const TwoBumpy scene(16);
    const TwoBumpy::Frame where = scene.at(18);
    std::vector<std::vector<std::byte>> results;
    for (const std::uint64_t seed : {1U, 2U}) {
        Tracker tracker(scene.a, scene.b);
        TrackSettings settings = TwoBumpy::settings(TrackMode::budget);
        settings.seed = seed;
        results.push_back(bytesOf(tracker.step(where.stateA(), where.stateB(), settings, {.work = 1000})));
    }
    EXPECT_NE(results[0], results[1]);
}

TEST(TrackerLaws, SavedAndLoadedInBetweenItIsTheSameRun) {
    const TwoBumpy scene(16);
    Tracker through(scene.a, scene.b);
    Tracker saved(scene.a, scene.b);
    Tracker copied(scene.a, scene.b);
    for (int frame = 12; frame < 26; ++frame) {
        const std::vector<std::byte> expected = bytesOf(stepOf(through, scene, frame, 1500));
        EXPECT_EQ(bytesOf(stepOf(saved, scene, frame, 1500)), expected);
        EXPECT_EQ(bytesOf(stepOf(copied, scene, frame, 1500)), expected);
        Tracker other(scene.a, scene.b);
        other.load(saved.save());
        saved = std::move(other);
        const Tracker copy = copied;
        copied = copy;
        Tracker another(copied);
        copied = std::move(another);
    }
    EXPECT_EQ(through.save(), saved.save());
    EXPECT_EQ(through.steps(), 14U);
}

TEST(TrackerLaws, AStateThatWasTamperedWithIsRefused) {
    const TwoBumpy scene(10);
    Tracker tracker(scene.a, scene.b);
    stepOf(tracker, scene, 18, unlimited);
    const std::vector<std::byte> sound = tracker.save();
    ASSERT_GT(sound.size(), 200U);
    Random random(9);
    const auto load = [&](std::span<const std::byte> bytes) { tracker.load(bytes); };
    for (std::size_t size = 0; size < sound.size(); size += 1 + sound.size() / 50) {
        EXPECT_EQ(faultOf([&] { load(std::span(sound).first(size)); }), Fault::badFile) << size;
    }
    for (int i = 0; i < 300; ++i) {
        std::vector<std::byte> broken = sound;
        broken[random.bits() % broken.size()] ^= static_cast<std::byte>(1U << random.bits() % 8U);
        EXPECT_EQ(faultOf([&] { load(broken); }), Fault::badFile);
    }
    EXPECT_EQ(tracker.save(), sound);
    const TwoBumpy larger(11);
    Tracker other(larger.a, larger.b);
    EXPECT_EQ(faultOf([&] { other.load(sound); }), Fault::topologyChanged);
    Tracker self(scene.a);
    EXPECT_EQ(faultOf([&] { self.load(sound); }), Fault::topologyChanged);
    load(sound);
    EXPECT_EQ(tracker.save(), sound);
}

TEST(TrackerLaws, SwappedBodiesGiveSwappedContacts) {
    const TwoBumpy scene(16);
    const TwoBumpy::Frame where = scene.at(18);
    for (const TrackMode mode : {TrackMode::exact, TrackMode::resolution}) {
        Tracker there(scene.a, scene.b);
        Tracker back(scene.b, scene.a);
        const TrackSettings settings = TwoBumpy::settings(mode);
        const TrackResult one = there.step(where.stateA(), where.stateB(), settings);
        const TrackResult two = back.step(where.stateB(), where.stateA(), settings);
        if (mode == TrackMode::exact) {
            std::vector<TrianglePair> pairs;
            std::vector<TrianglePair> swapped;
            for (const TrackedContact& contact : one.contacts) {
                pairs.push_back(contact.pair);
            }
            for (const TrackedContact& contact : two.contacts) {
                swapped.push_back({contact.pair.triangleB, contact.pair.triangleA});
            }
            std::sort(pairs.begin(), pairs.end());
            std::sort(swapped.begin(), swapped.end());
            std::vector<TrianglePair> different;
            std::ranges::set_symmetric_difference(pairs, swapped, std::back_inserter(different));
            EXPECT_LE(different.size(), pairs.size() / 500);  // those that rounding decides
        }
        EXPECT_NEAR(static_cast<double>(one.contacts.size()), static_cast<double>(two.contacts.size()),
                    0.02 * static_cast<double>(one.contacts.size()));
        EXPECT_GT(one.contacts.size(), 20U);
    }
}

TEST(TrackerLaws, MovedAsAWholeItIsTheSameScene) {
    const TwoBumpy scene(16);
    Random random(21);
    const TwoBumpy::Frame where = scene.at(18);
    Tracker plain(scene.a, scene.b);
    const TrackSettings settings = TwoBumpy::settings(TrackMode::exact);
    const TrackResult expected = plain.step(where.stateA(), where.stateB(), settings);
    for (int i = 0; i < 3; ++i) {
        const Pose pose{random.rotation(), 3 * random.direction()};
        SurfaceState a = where.stateA();
        SurfaceState b = where.stateB();
        a.pose = pose;
        b.pose = pose;
        Tracker tracker(scene.a, scene.b);
        const TrackResult moved = tracker.step(a, b, settings);
        EXPECT_TRUE(moved.certain);
        EXPECT_NEAR(static_cast<double>(moved.contacts.size()), static_cast<double>(expected.contacts.size()), 3);
        std::size_t alike = 0;
        for (const TrackedContact& contact : moved.contacts) {
            const auto same = std::ranges::find(expected.contacts, contact.pair, &TrackedContact::pair);
            if (same != expected.contacts.end() && !contact.overlapping && !same->overlapping) {
                EXPECT_NEAR(contact.signedDistance, same->signedDistance, 3e-6);
                ++alike;
            }
        }
        EXPECT_GT(alike, 20U);
    }
}

TEST(TrackerLaws, ARigidBodyNeedsNoPositions) {
    const TwoBumpy scene(16);
    const Pose pose{Eigen::Matrix3f::Identity(), {1.75F, 0.1F, -0.2F}};
    std::vector<Eigen::Vector3f> moved = scene.meshB.vertices;
    for (Eigen::Vector3f& vertex : moved) {
        vertex += pose.translation;
    }
    Tracker rigid(scene.a, scene.b);
    Tracker deforming(scene.a, scene.b);
    const TrackSettings settings = TwoBumpy::settings(TrackMode::exact);
    const TrackResult one = rigid.step(rigidState(), rigidState(pose), settings);
    const TrackResult two = deforming.step({}, {moved, {}, Stretch::measured(), {}}, settings);
    EXPECT_EQ(one.contacts.size(), two.contacts.size());
    EXPECT_GT(one.contacts.size(), 20U);
    EXPECT_EQ(one.stretchB, 1);
}

}  // namespace
}  // namespace grapeshot::test
