// Meshes and movements that nobody hopes for: defined, and the state kept.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include <grapeshot/adb/query.hpp>
#include <grapeshot/scf/tracker.hpp>

#include <adb/meshes.hpp>
#include <scf/tracked_scenes.hpp>
#include <support/oracle.hpp>
#include <support/poses.hpp>

namespace grapeshot::test {
namespace {

constexpr float noNumber = std::numeric_limits<float>::quiet_NaN();

scenes::Mesh fourOnOneEdge() {
    scenes::Mesh mesh{{{0, 0, 0}, {1, 0, 0}}, {}};
    for (int i = 0; i < 4; ++i) {
        const float angle = 0.4F * static_cast<float>(i);
        mesh.vertices.emplace_back(0.5F, std::cos(angle), std::sin(angle));
        mesh.triangles.push_back({0, 1, static_cast<std::uint32_t>(i + 2)});
    }
    mesh.triangles.push_back({0, 0, 1});
    mesh.triangles.push_back({3, 3, 3});
    return mesh;
}

std::vector<NamedMesh> oddMeshes() {
    return {{"soup", soup(120, 0.2F, 5)},
            {"needles", needles(40)},
            {"copies", copiesOfOne(40)},
            {"non-manifold", fourOnOneEdge()},
            {"open", scenes::grid(0.7F, 0.7F, 9, 9)},
            {"pieces", scenes::merged(scenes::sphere(0.3F, 4), scenes::sphere(0.3F, 4), {0.7F, 0.1F, 0})},
            {"through itself", scenes::merged(scenes::sphere(0.5F, 4), scenes::sphere(0.5F, 4), {0.3F, 0.1F, 0})},
            {"one", {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}}}};
}

TEST(OddMeshes, AreTrackedAsAnyOther) {
    Random random(31);
    std::size_t total = 0;
    for (const NamedMesh& first : oddMeshes()) {
        for (const NamedMesh& second : oddMeshes()) {
            SCOPED_TRACE(first.name + ", " + second.name);
            const BallTree a = buildBallTree(first.mesh.view());
            const BallTree b = buildBallTree(second.mesh.view());
            Tracker tracker(a, b);
            TrackSettings settings;
            settings.maxDistance = 0.03F;
            settings.spacing = 0.2F;
            for (int step = 0; step < 4; ++step) {
                const Pose pose{random.rotation(), 0.3F * random.direction()};
                settings.mode = TrackMode::exact;
                const TrackResult exact = Tracker(a, b).step(rigidState(), rigidState(pose), settings);
                EXPECT_TRUE(exact.certain);
                const auto truth = bruteForcePairs(first.mesh.view(), second.mesh.view(), pose, 0.03);
                EXPECT_NEAR(static_cast<double>(exact.contacts.size()), static_cast<double>(truth.size()),
                            1 + 0.002 * static_cast<double>(truth.size()));
                total += truth.size();
                for (const TrackMode mode : {TrackMode::resolution, TrackMode::budget}) {
                    settings.mode = mode;
                    const TrackResult result = tracker.step(rigidState(), rigidState(pose), settings);
                    EXPECT_TRUE(result.certain);
                    EXPECT_EQ(result.contacts.empty(), exact.contacts.empty());
                    for (const TrackedContact& contact : result.contacts) {
                        EXPECT_NE(std::ranges::find(exact.contacts, contact.pair, &TrackedContact::pair),
                                  exact.contacts.end());
                    }
                }
            }
        }
    }
    EXPECT_GT(total, 5000U);
}

TEST(OddMeshes, WithThemselvesToo) {
    for (const NamedMesh& mesh : oddMeshes()) {
        SCOPED_TRACE(mesh.name);
        const BallTree tree = buildBallTree(mesh.mesh.view());
        TrackSettings settings;
        settings.maxDistance = 0.03F;
        for (const TrackMode mode : {TrackMode::exact, TrackMode::resolution, TrackMode::budget}) {
            settings.mode = mode;
            const TrackResult result = Tracker(tree).step({}, settings);
            EXPECT_TRUE(result.certain);
            // Triangles that share a vertex do not count; those of the others lie apart.
            EXPECT_EQ(!result.contacts.empty(),
                      mesh.name == "soup" || mesh.name == "needles" || mesh.name == "through itself")
                << result.contacts.size();
        }
    }
}

/// Refused, with nothing listed and the memory as before.
void expectRefused(Tracker& tracker, const SurfaceState& a, const SurfaceState& b, const TrackSettings& settings,
                   Fault fault) {
    const std::vector<std::byte> before = tracker.save();
    const TrackResult result = tracker.step(a, b, settings);
    EXPECT_EQ(result.stop, StopReason::invalidInput);
    EXPECT_EQ(result.fault, fault);
    EXPECT_TRUE(result.contacts.empty());
    EXPECT_FALSE(result.certain);
    EXPECT_EQ(tracker.save(), before);
}

TEST(OddInput, IsNamedAndLeavesTheTrackerAsItWas) {
    const TwoBumpy scene(10);
    Tracker tracker(scene.a, scene.b);
    const TwoBumpy::Frame where = scene.at(18);
    const TrackSettings settings = TwoBumpy::settings(TrackMode::budget);
    ASSERT_GT(tracker.step(where.stateA(), where.stateB(), settings).tracked, 5U);

    const std::span<const Eigen::Vector3f> fewer(where.a.data(), where.a.size() - 1);
    expectRefused(tracker, {fewer, {}, {}, {}}, where.stateB(), settings, Fault::topologyChanged);
    std::vector<Triangle> changed = scene.meshB.triangles;
    std::swap(changed[3][0], changed[3][1]);
    SurfaceState other = where.stateB();
    other.triangles = changed;
    expectRefused(tracker, where.stateA(), other, settings, Fault::topologyChanged);
    other.triangles = std::span(scene.meshB.triangles).first(7);
    expectRefused(tracker, where.stateA(), other, settings, Fault::topologyChanged);
    other.triangles = scene.meshB.triangles;
    EXPECT_EQ(tracker.step(where.stateA(), other, settings).fault, std::nullopt);

    SurfaceState bent = where.stateA();
    bent.pose = Pose{2 * Eigen::Matrix3f::Identity(), Eigen::Vector3f::Zero()};
    expectRefused(tracker, bent, where.stateB(), settings, Fault::notRigid);
    bent.pose = Pose{Eigen::Matrix3f::Identity(), {0, noNumber, 0}};
    expectRefused(tracker, bent, where.stateB(), settings, Fault::notRigid);

    for (const auto& spoil : std::vector<void (*)(TrackSettings&)>{
             [](TrackSettings& s) { s.maxDistance = -1; }, [](TrackSettings& s) { s.maxDistance = noNumber; },
             [](TrackSettings& s) { s.spacing = 0; }, [](TrackSettings& s) { s.spacing = noNumber; },
             [](TrackSettings& s) { s.followDistance = -1; }, [](TrackSettings& s) { s.exclusion = noNumber; },
             [](TrackSettings& s) { s.frontCells = 15; }, [](TrackSettings& s) { s.frontCells = 4097; },
             [](TrackSettings& s) { s.auditShare = 1.1F; }, [](TrackSettings& s) { s.lookAhead = -1; },
             [](TrackSettings& s) { s.lookAhead = noNumber; }}) {
        TrackSettings bad = settings;
        spoil(bad);
        expectRefused(tracker, where.stateA(), where.stateB(), bad, Fault::badSetting);
    }
    for (const float bound : {0.0F, -1.0F, noNumber, std::numeric_limits<float>::infinity()}) {
        expectRefused(tracker, where.stateA(Stretch::given(bound)), where.stateB(), settings, Fault::badSetting);
    }
}

TEST(OddInput, PositionsThatAreNoNumbers) {
    const TwoBumpy scene(10);
    const TwoBumpy::Frame sound = scene.at(18);
    for (const TrackMode mode : {TrackMode::exact, TrackMode::resolution, TrackMode::budget}) {
        const TrackSettings settings = TwoBumpy::settings(mode);
        Tracker tracker(scene.a, scene.b);
        const TrackResult before = tracker.step(sound.stateA(), sound.stateB(), settings);
        ASSERT_FALSE(before.contacts.empty());
        TwoBumpy::Frame broken = sound;
        // A corner in contact, which every way of looking reads.
        broken.a[scene.meshA.triangles[before.contacts[0].pair.triangleA][0]][1] = noNumber;
        for (const Stretch& stretch : {Stretch::given(3), Stretch::measured(), Stretch::refitted()}) {
            expectRefused(tracker, broken.stateA(stretch), broken.stateB(), settings, Fault::notFinite);
        }
        EXPECT_EQ(tracker.step(sound.stateA(), sound.stateB(), settings).fault, std::nullopt);
    }
    // All of them: whatever is looked at first.
    std::vector<Eigen::Vector3f> nothing(sound.a.size(), Eigen::Vector3f::Constant(noNumber));
    Tracker tracker(scene.a, scene.b);
    for (const Stretch& stretch : {Stretch::given(3), Stretch::measured(), Stretch::refitted()}) {
        expectRefused(tracker, {nothing, {}, stretch, {}}, sound.stateB(), TwoBumpy::settings(TrackMode::budget),
                      Fault::notFinite);
    }
}

TEST(OddInput, VerticesThatJumpAreFoundByMeasuring) {
    const TwoBumpy scene(10);
    TwoBumpy::Frame where = scene.at(0);
    // One vertex of A jumps into the middle of B.
    where.a[17] = Eigen::Vector3f(2.25F, 0.1F, -0.2F);
    const MeshView a{where.a, scene.meshA.triangles};
    const MeshView b{where.b, scene.meshB.triangles};
    const auto truth = bruteForcePairs(a, b, {}, 0.02);
    ASSERT_GT(truth.size(), 3U);
    const TrackSettings settings = TwoBumpy::settings(TrackMode::exact);
    for (const Stretch& stretch : {Stretch::measured(), Stretch::measured(1000), Stretch::refitted()}) {
        const TrackResult result = Tracker(scene.a, scene.b).step(where.stateA(stretch), where.stateB(), settings);
        EXPECT_TRUE(result.certain);
        EXPECT_NEAR(static_cast<double>(result.contacts.size()), static_cast<double>(truth.size()), 1);
        EXPECT_EQ(result.stretchA == 0, stretch.bound < 1000);  // beyond the limit balls are fitted
    }
    // A given bound is believed.
    const TrackResult believed =
        Tracker(scene.a, scene.b).step(where.stateA(Stretch::given(1.2F)), where.stateB(), settings);
    EXPECT_LT(believed.contacts.size(), truth.size());
    // The jump is over: contacts that it tore away are gone, nothing else.
    Tracker tracker(scene.a, scene.b);
    TrackSettings sampled = TwoBumpy::settings(TrackMode::budget);
    EXPECT_FALSE(tracker.step(where.stateA(), where.stateB(), sampled).contacts.empty());
    where = scene.at(0);
    const TrackResult after = tracker.step(where.stateA(), where.stateB(), sampled);
    EXPECT_TRUE(after.certain);
    EXPECT_EQ(after.contacts.empty(),
              Tracker(scene.a, scene.b).step(where.stateA(), where.stateB(), settings).contacts.empty());
}

TEST(OddInput, ABodyThatShrinksToAPoint) {
    const TwoBumpy scene(10);
    const std::vector<Eigen::Vector3f> point(scene.meshA.vertices.size(), scene.meshB.vertices[0]);
    for (const Stretch& stretch : {Stretch::given(1), Stretch::measured(), Stretch::refitted()}) {
        TrackSettings settings = TwoBumpy::settings(TrackMode::exact);
        settings.maxDistance = 1e-3F;
        const TrackResult result =
            Tracker(scene.a, scene.b).step({point, {}, stretch, {}}, {{}, {}, Stretch::given(1), {}}, settings);
        EXPECT_TRUE(result.certain);
        // Every triangle of A, with all around that vertex of B and what is within a millimetre.
        EXPECT_GE(result.contacts.size(), scene.meshA.triangles.size() * scene.b.surface.fan.of(0).size());
    }
}

}  // namespace
}  // namespace grapeshot::test
