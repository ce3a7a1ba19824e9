// Sides of sheets: kept while they are pushed through each other, and what depths make of them.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include <grapeshot/core/bytes.hpp>
#include <grapeshot/scf/side.hpp>

#include <adb/meshes.hpp>
#include <scenes/shapes.hpp>
#include <support/fault_of.hpp>
#include <support/poses.hpp>

namespace grapeshot::test {
namespace {

/// A sheet and a needle above it, which goes straight down.
struct NeedleAndSheet {
    NeedleAndSheet() {
        for (Eigen::Vector3f& vertex : needle.vertices) {
            vertex = {0.04F * vertex[0], 0.3F * vertex[1], 0.04F * vertex[2]};
        }
    }
    [[nodiscard]] static Pose at(float tip) { return {Eigen::Matrix3f::Identity(), {0.013F, tip + 0.3F, -0.021F}}; }
    [[nodiscard]] static TrackSettings settings() {
        TrackSettings result;
        result.mode = TrackMode::resolution;
        result.maxDistance = 0.02F;
        result.spacing = 0.05F;
        return result;
    }
    scenes::Mesh needle = scenes::sphere(1, 6);
    scenes::Mesh sheet = scenes::grid(1, 1, 30, 30);
};

TEST(Side, ANeedleThatIsPushedThroughASheetIsPulledBack) {
    const NeedleAndSheet scene;
    const BallTree a = buildBallTree(scene.needle.view());
    const BallTree b = buildBallTree(scene.sheet.view());
    for (const float stepLength : {0.004F, 0.03F, 0.1F}) {
        Tracker tracker(a, b);
        SideKeeper keeper(a, b);
        DepthQuery query(a, b);
        DepthMemory memory;
        std::size_t crossed = 0;
        float before = 0.05F;
        // Down, until the upper end comes near, and up again.
        const int steps = static_cast<int>(0.5F / stepLength);
        for (int step = 0; step < 2 * steps; ++step) {
            const float tip = 0.05F - stepLength * static_cast<float>(std::min(step, 2 * steps - step));
            const Pose now = NeedleAndSheet::at(tip);
            const RigidMotion motion = motionBetween(NeedleAndSheet::at(before), now);
            before = tip;
            const TrackResult contacts = tracker.step(rigidState(now), rigidState(), NeedleAndSheet::settings());
            const SideResult sided = keeper.step(rigidMotion(motion), rigidMotion(), contacts.contacts);
            ASSERT_EQ(sided.contacts.size(), contacts.contacts.size());
            for (const SidedContact& contact : sided.contacts) {
                EXPECT_EQ(contact.sides.ofB, 1) << tip;
                EXPECT_EQ(contact.sides.ofA, 1) << tip;
                EXPECT_EQ(contact.isCrossed, contact.signedDistance <= 0);
                crossed += contact.isCrossed ? 1 : 0;
            }
            const std::vector<ContactSides> sides = sided.sides();
            if (contacts.contacts.empty()) {
                continue;
            }
            const DepthResult depths =
                query.measure(rigidState(now), rigidState(), contacts.contacts, sides, {.spacing = 0.15F}, memory);
            ASSERT_TRUE(depths.complete);
            if (tip < -0.01F) {
                ASSERT_EQ(depths.regions.size(), 1U) << tip;
                EXPECT_EQ(depths.regions[0].source, DepthSource::vertexOfA);
                EXPECT_NEAR(depths.regions[0].depth, -tip, 1e-5F);
                EXPECT_GT(depths.regions[0].normal[1], 0.9999F);
            } else if (tip > 0) {
                EXPECT_TRUE(depths.regions.empty());
            }
        }
        EXPECT_GT(crossed, static_cast<std::size_t>(steps));
    }
}

/// Two waving sheets, the upper of which sinks through the lower: A's normals and B's point up.
struct SinkingSheet {
    [[nodiscard]] std::vector<Eigen::Vector3f> upper(float height, float phase) const {
        std::vector<Eigen::Vector3f> moved = mesh.vertices;
        for (Eigen::Vector3f& v : moved) {
            v[1] = height + 0.04F * std::sin(5 * v[0] + 3 * v[2] + phase);
        }
        return moved;
    }
    [[nodiscard]] std::vector<Eigen::Vector3f> lower(float phase) const {
        std::vector<Eigen::Vector3f> moved = mesh.vertices;
        for (Eigen::Vector3f& v : moved) {
            v[1] = 0.04F * std::cos(4 * v[0] - 4 * v[2] + phase);
        }
        return moved;
    }
    [[nodiscard]] static TrackSettings settings() {
        TrackSettings result;
        result.maxDistance = 0.01F;
        result.spacing = 0.06F;
        result.frontCells = 128;
        return result;
    }
    scenes::Mesh mesh = scenes::grid(1, 1, 40, 40);
};

struct SinkingTally {
    double contacts = 0, right = 0, rightNow = 0, crossed = 0, crossedRight = 0;
};

SinkingTally sink(const SinkingSheet& scene, float speed, std::uint64_t work) {
    const BallTree a = buildBallTree(scene.mesh.view());
    const BallTree b = a;
    Tracker tracker(a, b);
    SideKeeper keeper(a, b);
    SinkingTally tally;
    std::vector<Eigen::Vector3f> beforeA = scene.upper(0.12F, 0);
    std::vector<Eigen::Vector3f> beforeB = scene.lower(0);
    for (float height = 0.12F; height > -0.12F; height -= speed) {
        const float phase = 3 * height;
        const std::vector<Eigen::Vector3f> nowA = scene.upper(height, phase);
        const std::vector<Eigen::Vector3f> nowB = scene.lower(phase);
        const TrackResult contacts =
            tracker.step({nowA, {}, Stretch::measured(), {}}, {nowB, {}, Stretch::measured(), {}},
                         SinkingSheet::settings(), {.work = work});
        const SideResult sided = keeper.step({beforeA, nowA, {}, {}, {}}, {beforeB, nowB, {}, {}, {}},
                                             contacts.contacts, {.spacing = 0.06F});
        for (std::size_t i = 0; i < sided.contacts.size(); ++i) {
            const SidedContact& one = sided.contacts[i];
            ++tally.contacts;
            tally.right += one.sides.ofB == 1 && one.sides.ofA == -1 ? 1 : 0;
            tally.rightNow += contacts.contacts[i].normal[1] > 0 && !contacts.contacts[i].overlapping ? 1 : 0;
            if (!contacts.contacts[i].overlapping && contacts.contacts[i].normal[1] < -0.5F) {
                ++tally.crossed;
                tally.crossedRight += one.isCrossed && one.normal[1] > 0.5F && one.signedDistance < 0 ? 1 : 0;
            }
        }
        beforeA = nowA;
        beforeB = nowB;
    }
    return tally;
}

TEST(Side, OfASheetThatSinksThroughAnotherIsTheOneItCameFrom) {
    const SinkingSheet scene;
    for (const float speed : {0.002F, 0.01F, 0.03F}) {
        for (const std::uint64_t work : {std::uint64_t{1500}, unlimited}) {
            const SinkingTally tally = sink(scene, speed, work);
            EXPECT_GT(tally.contacts, 200);
            // A contact that is found late, away from all others, may have been on the wrong side by then.
            EXPECT_GE(tally.right, (work == unlimited ? 0.999 : 0.99) * tally.contacts);
            EXPECT_GE(tally.crossedRight, (work == unlimited ? 0.999 : 0.98) * tally.crossed);
            EXPECT_LT(tally.rightNow, 0.7 * tally.contacts);  // what they look like is not where they belong
        }
    }
}

/// A strip that is folded in two, whose upper half sinks through the lower.
std::vector<Eigen::Vector3f> folded(const scenes::Mesh& strip, float gap) {
    std::vector<Eigen::Vector3f> moved;
    for (const Eigen::Vector3f& v : strip.vertices) {
        const float bend = std::clamp(v[0] / 0.3F, -1.0F, 1.0F);  // -1: lower half, 1: upper
        const float away = std::abs(v[0]);
        moved.emplace_back(away, 0.5F * gap * bend, v[2] + 0.02F * bend);
    }
    return moved;
}

TEST(Side, OfABodyWithItselfItIsKeptToo) {
    const scenes::Mesh strip = scenes::grid(1, 0.3F, 60, 16);
    const BallTree tree = buildBallTree(strip.view());
    Tracker tracker(tree);
    SideKeeper keeper(tree);
    TrackSettings settings;
    settings.mode = TrackMode::resolution;
    settings.maxDistance = 0.02F;
    settings.spacing = 0.08F;
    settings.exclusion = 0.7F;
    std::vector<Eigen::Vector3f> before = folded(strip, 0.1F);
    std::size_t crossed = 0;
    for (int step = 0; step <= 20; ++step) {
        const float gap = 0.1F - 0.007F * static_cast<float>(step);
        const std::vector<Eigen::Vector3f> now = folded(strip, gap);
        const TrackResult contacts = tracker.step({now, {}, Stretch::measured(), {}}, settings);
        const SideResult sided = keeper.step({before, now, {}, {}, {}}, contacts.contacts, {.spacing = 0.08F});
        for (std::size_t i = 0; i < sided.contacts.size(); ++i) {
            const SidedContact& one = sided.contacts[i];
            const Triangle& corners = strip.triangles[contacts.contacts[i].pair.triangleA];
            // The lower half belongs below, whichever of both it is.
            const bool lowerIsA = strip.vertices[corners[0]][0] < 0;
            EXPECT_GT((lowerIsA ? -1.0F : 1.0F) * one.normal[1], 0) << gap;
            crossed += one.isCrossed ? 1 : 0;
        }
        before = now;
    }
    EXPECT_GT(crossed, 50U);
}

std::vector<std::byte> sideBytes(const SideResult& result) {
    std::vector<std::byte> bytes;
    ByteWriter writer(bytes);
    for (const SidedContact& contact : result.contacts) {
        writer.put(contact.sides.ofA);
        writer.put(contact.sides.ofB);
        writer.put(contact.source);
        writer.put(contact.isCrossed);
        writer.put(contact.normal);
        writer.put(contact.signedDistance);
    }
    writer.put(std::uint64_t{result.kept});
    return bytes;
}

TEST(Side, SavedCopiedOrOnAnotherInstructionSetItIsTheSame) {
    const InstructionSetGuard guard;
    const SinkingSheet scene;
    const BallTree a = buildBallTree(scene.mesh.view());
    const BallTree b = a;
    std::vector<std::byte> first;
    for (const InstructionSet set : instructionSets()) {
        limitInstructionSet(set);
        Tracker tracker(a, b);
        SideKeeper keeper(a, b);
        SideKeeper saved(a, b);
        std::vector<std::byte> all;
        std::vector<Eigen::Vector3f> before = scene.upper(0.1F, 0);
        const std::vector<Eigen::Vector3f> lower = scene.lower(0);
        for (int step = 0; step < 12; ++step) {
            const std::vector<Eigen::Vector3f> now = scene.upper(0.1F - 0.015F * static_cast<float>(step), 0);
            const TrackResult contacts =
                tracker.step({now, {}, {}, {}}, {lower, {}, {}, {}}, SinkingSheet::settings(), {.work = 1000});
            const SurfaceMotion motionA{before, now, {}, {}, {}};
            const SurfaceMotion motionB{lower, lower, {}, {}, {}};
            const std::vector<std::byte> bytes = sideBytes(keeper.step(motionA, motionB, contacts.contacts));
            EXPECT_EQ(sideBytes(saved.step(motionA, motionB, contacts.contacts)), bytes);
            all.insert(all.end(), bytes.begin(), bytes.end());
            SideKeeper loaded(a, b);
            loaded.load(saved.save());
            const SideKeeper copy = loaded;
            saved = copy;
            before = now;
        }
        const std::vector<std::byte> state = keeper.save();
        all.insert(all.end(), state.begin(), state.end());
        first = first.empty() ? all : first;
        EXPECT_EQ(all, first);
    }
    EXPECT_GT(first.size(), 2000U);
}

TEST(Side, ASheetThatWasAwayLongEnoughMayComeFromTheOtherSide) {
    const NeedleAndSheet scene;
    const BallTree a = buildBallTree(scene.needle.view());
    const BallTree b = buildBallTree(scene.sheet.view());
    for (const int away : {2, 10}) {
        Tracker tracker(a, b);
        SideKeeper keeper(a, b);
        const SideSettings settings{.keepSteps = 5};
        const auto step = [&](const Pose& from, const Pose& to) {
            const TrackResult contacts = tracker.step(rigidState(to), rigidState(), NeedleAndSheet::settings());
            return keeper.step(rigidMotion(motionBetween(from, to)), rigidMotion(), contacts.contacts, settings);
        };
        const Pose above = NeedleAndSheet::at(0.01F);
        EXPECT_EQ(step(above, above).contacts.at(0).sides.ofB, 1);
        // The same end of it, from below.
        const Pose below{Eigen::AngleAxisf(3.1415927F, Eigen::Vector3f::UnitZ()).toRotationMatrix(),
                         {0.013F, -0.31F, -0.021F}};
        for (int i = 0; i < away; ++i) {
            const Pose far = NeedleAndSheet::at(-2);
            EXPECT_TRUE(step(far, far).contacts.empty());
        }
        EXPECT_EQ(step(below, below).contacts.at(0).sides.ofB, away == 2 ? 1 : -1);
    }
}

TEST(Side, OddInputIsNamed) {
    const NeedleAndSheet scene;
    const BallTree a = buildBallTree(scene.needle.view());
    const BallTree b = buildBallTree(scene.sheet.view());
    Tracker tracker(a, b);
    const Pose pose = NeedleAndSheet::at(-0.1F);
    const std::vector<TrackedContact> contacts =
        tracker.step(rigidState(pose), rigidState(), NeedleAndSheet::settings()).contacts;
    ASSERT_FALSE(contacts.empty());
    SideKeeper keeper(a, b);
    ASSERT_EQ(keeper.step(rigidMotion({pose}), rigidMotion(), contacts).fault, std::nullopt);
    const std::vector<std::byte> state = keeper.save();
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const auto fault = [&](const SurfaceMotion& motion, std::span<const TrackedContact> given,
                           const SideSettings& settings = {}) {
        const SideResult result = keeper.step(motion, rigidMotion(), given, settings);
        EXPECT_TRUE(result.contacts.empty() || !result.fault);
        EXPECT_EQ(keeper.save(), state);
        return result.fault;
    };
    EXPECT_EQ(fault(rigidMotion({pose}), contacts, {.spacing = 0}), Fault::badSetting);
    EXPECT_EQ(fault(rigidMotion({pose}), contacts, {.spacing = nan}), Fault::badSetting);
    std::vector<TrackedContact> broken = contacts;
    broken[0].pair.triangleB = 1'000'000;
    EXPECT_EQ(fault(rigidMotion({pose}), broken), Fault::badSetting);
    broken = contacts;
    broken[0].onB[2] = nan;
    EXPECT_EQ(fault(rigidMotion({pose}), broken), Fault::notFinite);
    EXPECT_EQ(fault(rigidMotion({{2 * Eigen::Matrix3f::Identity(), {0, 0, 0}}}), contacts), Fault::notRigid);
    std::vector<Eigen::Vector3f> moved(scene.needle.vertices.size(), Eigen::Vector3f::Constant(nan));
    EXPECT_EQ(fault({moved, {}, {pose}, {}, {}}, contacts), Fault::notFinite);
    moved.pop_back();
    EXPECT_EQ(fault({{}, moved, {pose}, {}, {}}, contacts), Fault::topologyChanged);
    EXPECT_EQ(fault({{}, {}, {pose}, {}, scene.sheet.triangles}, contacts), Fault::topologyChanged);

    for (std::size_t i = 0; i < state.size(); ++i) {
        std::vector<std::byte> tampered = state;
        tampered[i] ^= std::byte{1};
        EXPECT_EQ(faultOf([&] { keeper.load(tampered); }), Fault::badFile) << i;
        EXPECT_EQ(faultOf([&] { keeper.load(std::span(state).first(i)); }), Fault::badFile) << i;
    }
    SideKeeper other(b, a);
    EXPECT_EQ(faultOf([&] { other.load(state); }), Fault::topologyChanged);
    EXPECT_EQ(keeper.save(), state);
    keeper.clear();
    EXPECT_NE(keeper.save(), state);
}

}  // namespace
}  // namespace grapeshot::test
