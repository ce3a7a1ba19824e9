// Laws of depths: swapped bodies, moved scenes, budgets, what is kept from step to step, odd input.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include <grapeshot/core/bytes.hpp>
#include <grapeshot/scf/depth.hpp>

#include <adb/meshes.hpp>
#include <scf/depth_scenes.hpp>
#include <support/fault_of.hpp>

namespace grapeshot::test {
namespace {

/// Bumpy spheres of diagonal 2, in each other at one or two places.
struct BumpySolids : SolidPair {
    explicit BumpySolids(int frequency = 12)
        : SolidPair(scenes::normalised(scenes::bumpySphere(1, 0.3F, 7, frequency, 3)),
                    scenes::normalised(scenes::bumpySphere(1, 0.25F, 5, frequency, 4))) {}
    /// Goes in and out again, and turns.
    [[nodiscard]] static Pose at(int frame) {
        const float t = 0.05F * static_cast<float>(frame);
        return {Eigen::AngleAxisf(0.3F * t, Eigen::Vector3f(1, 2, 3).normalized()).toRotationMatrix(),
                {1.0F - 0.4F * std::sin(t), 0.1F, -0.05F}};
    }
};

std::vector<std::byte> depthBytes(const DepthResult& result) {
    std::vector<std::byte> bytes;
    ByteWriter writer(bytes);
    for (const DepthRegion& region : result.regions) {
        writer.put(region.normal);
        writer.put(region.depth);
        writer.put(region.onA);
        writer.put(region.onB);
        writer.put(region.source);
        writer.put(region.vertex);
        writer.put(region.triangle);
        writer.put(region.contacts);
        writer.put(region.age);
    }
    writer.put(result.complete);
    writer.put(result.work);
    return bytes;
}

std::vector<float> sortedDepths(const DepthResult& result) {
    std::vector<float> depths;
    for (const DepthRegion& region : result.regions) {
        depths.push_back(region.depth);
    }
    std::ranges::sort(depths);
    return depths;
}

TEST(DepthLaws, SwappedBodiesHaveTheSameDepthsTheOtherWay) {
    BumpySolids scene;
    const Surface& surfaceA = scene.a.surface;
    const Surface& surfaceB = scene.b.surface;
    SolidPair swapped({surfaceB.rest, surfaceB.triangles}, {surfaceA.rest, surfaceA.triangles});
    for (int frame = 5; frame < 40; frame += 5) {
        const Pose bInA = BumpySolids::at(frame);
        const DepthResult one = scene.measure(bInA, scene.cutsAt(bInA));
        swapped.poseA = bInA;
        const DepthResult other = swapped.measure({}, swapped.cutsAt({}));
        ASSERT_EQ(one.regions.size(), other.regions.size());
        ASSERT_FALSE(one.regions.empty());
        const std::vector<float> depths = sortedDepths(one);
        const std::vector<float> back = sortedDepths(other);
        for (std::size_t i = 0; i < depths.size(); ++i) {
            EXPECT_NEAR(depths[i], back[i], 1e-5F);
        }
        if (one.regions.size() == 1) {
            EXPECT_LT((one.regions[0].normal + other.regions[0].normal).norm(), 1e-3F);
            EXPECT_LT((one.regions[0].onA - other.regions[0].onB).norm(), 1e-5F);
        }
    }
}

TEST(DepthLaws, MovedAsAWholeTheyStay) {
    BumpySolids scene;
    Random random(3);
    for (int frame = 5; frame < 40; frame += 5) {
        const Pose bInA = BumpySolids::at(frame);
        scene.poseA = {};
        const std::vector<float> here = sortedDepths(scene.measure(bInA, scene.cutsAt(bInA)));
        scene.poseA = {random.rotation(), 2 * random.direction()};
        const Pose there = compose(scene.poseA, bInA);
        const std::vector<float> moved = sortedDepths(scene.measure(there, scene.cutsAt(there)));
        ASSERT_EQ(here.size(), moved.size());
        for (std::size_t i = 0; i < here.size(); ++i) {
            EXPECT_NEAR(here[i], moved[i], 1e-5F);
        }
    }
}

TEST(DepthLaws, FromTheSummitsBeforeTheyAreAsDeepAndCheaper) {
    BumpySolids scene(20);
    DepthMemory memory;
    std::uint64_t cold = 0;
    std::uint64_t warm = 0;
    std::size_t regions = 0;
    std::uint32_t oldest = 0;
    for (int frame = 5; frame < 45; ++frame) {
        const Pose bInA = BumpySolids::at(frame);
        const std::vector<TrackedContact> cuts = scene.cutsAt(bInA);
        const DepthResult fresh = scene.measure(bInA, cuts);
        const DepthResult followed = scene.follow(bInA, cuts, memory);
        ASSERT_TRUE(fresh.complete && followed.complete);
        ASSERT_EQ(fresh.regions.size(), followed.regions.size()) << frame;
        for (std::size_t i = 0; i < fresh.regions.size(); ++i) {
            EXPECT_GE(followed.regions[i].depth, 0.99F * fresh.regions[i].depth) << frame;
            oldest = std::max(oldest, followed.regions[i].age);
        }
        cold += fresh.work;
        warm += followed.work;
        regions += fresh.regions.size();
    }
    EXPECT_GE(regions, 40U);
    EXPECT_GE(oldest, 30U);
    EXPECT_LT(warm, cold);
}

TEST(DepthLaws, AlongTheCutsTheyAreFollowedToo) {
    BumpySolids scene(12);
    scene.settings.spacing = 0;
    DepthMemory memory;
    std::uint32_t oldest = 0;
    for (int frame = 0; frame < 60; ++frame) {
        const Pose bInA = BumpySolids::at(5 + frame / 6);  // slow: it moves within triangles
        const std::vector<TrackedContact> cuts = scene.cutsAt(bInA);
        const DepthResult fresh = scene.measure(bInA, cuts);
        const DepthResult followed = scene.follow(bInA, cuts, memory);
        ASSERT_EQ(fresh.regions.size(), followed.regions.size()) << frame;
        for (std::size_t i = 0; i < fresh.regions.size(); ++i) {
            EXPECT_GE(followed.regions[i].depth, 0.99F * fresh.regions[i].depth) << frame;
            oldest = std::max(oldest, followed.regions[i].age);
        }
    }
    EXPECT_GE(oldest, 5U);
}

TEST(DepthLaws, ABodyThatHasGoneInAltogetherIsFollowed) {
    const scenes::Mesh outer = scenes::sphere(1, 8);
    const scenes::Mesh inner = scenes::sphere(0.15F, 3);
    SolidPair pair(outer, inner);
    pair.settings.containment = false;  // the memory alone
    DepthMemory memory;
    float before = 0;
    for (int frame = 0; frame < 12; ++frame) {
        const Pose bInA{Eigen::Matrix3f::Identity(), {1.1F - 0.05F * static_cast<float>(frame), 0.01F, 0.02F}};
        const DepthResult result = pair.follow(bInA, pair.cutsAt(bInA), memory);
        ASSERT_EQ(result.regions.size(), 1U) << frame;
        EXPECT_GT(result.regions[0].depth, before);
        EXPECT_LT(result.regions[0].normal[0], -0.9F);
        before = result.regions[0].depth;
    }
    EXPECT_EQ(memory.summits.size(), 1U);
    const Pose gone{Eigen::Matrix3f::Identity(), {3, 0, 0}};
    EXPECT_TRUE(pair.follow(gone, {}, memory).regions.empty());
    EXPECT_TRUE(memory.summits.empty());
}

TEST(DepthLaws, MoreBudgetIsNeverWorse) {
    BumpySolids scene;
    const Pose bInA = BumpySolids::at(25);
    const std::vector<TrackedContact> cuts = scene.cutsAt(bInA);
    const DepthResult full = scene.measure(bInA, cuts);
    ASSERT_FALSE(full.regions.empty());
    std::size_t regions = 0;
    std::size_t incomplete = 0;
    for (std::uint64_t work = 0; work <= full.work + 10; work += 10 + full.work / 200) {
        const DepthResult result = scene.measure(bInA, cuts, {.work = work});
        EXPECT_GE(result.regions.size(), regions);
        EXPECT_LE(result.work, work + 600);
        EXPECT_EQ(result.complete, result.stop == StopReason::certain);
        for (const DepthRegion& region : result.regions) {
            EXPECT_TRUE(region.isChecked || !result.complete || region.source == DepthSource::crossing);
        }
        incomplete += result.complete ? 0 : 1;
        regions = result.regions.size();
    }
    EXPECT_EQ(regions, full.regions.size());
    EXPECT_GT(incomplete, 3U);
    // Without a budget nothing is said, and nothing is forgotten.
    DepthMemory memory;
    ASSERT_TRUE(scene.follow(bInA, cuts, memory).complete);
    const DepthMemory known = memory;
    EXPECT_TRUE(scene.follow(bInA, cuts, memory, {.work = 0}).regions.empty());
    EXPECT_EQ(memory, known);
}

TEST(DepthLaws, SameBytesOnEveryInstructionSet) {
    const InstructionSetGuard guard;
    BumpySolids scene;
    std::vector<std::byte> first;
    for (const InstructionSet set : instructionSets()) {
        limitInstructionSet(set);
        DepthMemory memory;
        std::vector<std::byte> all;
        for (int frame = 5; frame < 25; ++frame) {
            const Pose bInA = BumpySolids::at(frame);
            const auto bytes = depthBytes(scene.follow(bInA, scene.cutsAt(bInA), memory));
            all.insert(all.end(), bytes.begin(), bytes.end());
            memory = loadDepths(saveDepths(memory, scene.a, scene.b), scene.a, scene.b);
        }
        first = first.empty() ? all : first;
        EXPECT_EQ(all, first);
    }
    EXPECT_GT(first.size(), 1000U);
}

TEST(DepthLaws, SavedSummitsThatWereTamperedWithAreRefused) {
    BumpySolids scene;
    DepthMemory memory;
    const Pose bInA = BumpySolids::at(25);
    ASSERT_TRUE(scene.follow(bInA, scene.cutsAt(bInA), memory).complete);
    ASSERT_FALSE(memory.summits.empty());
    const std::vector<std::byte> sound = saveDepths(memory, scene.a, scene.b);
    EXPECT_EQ(loadDepths(sound, scene.a, scene.b), memory);
    const auto load = [&](std::span<const std::byte> bytes) { static_cast<void>(loadDepths(bytes, scene.a, scene.b)); };
    for (std::size_t size = 0; size < sound.size(); ++size) {
        EXPECT_EQ(faultOf([&] { load(std::span(sound).first(size)); }), Fault::badFile) << size;
    }
    for (std::size_t i = 0; i < sound.size(); ++i) {
        std::vector<std::byte> broken = sound;
        broken[i] ^= std::byte{4};
        EXPECT_EQ(faultOf([&] { load(broken); }), Fault::badFile) << i;
    }
    const BumpySolids larger(13);
    EXPECT_EQ(faultOf([&] { static_cast<void>(loadDepths(sound, scene.a, larger.b)); }), Fault::topologyChanged);
    EXPECT_EQ(faultOf([&] { static_cast<void>(loadDepths(sound, scene.a, scene.a)); }), Fault::topologyChanged);
}

TEST(DepthLaws, OddInputIsNamed) {
    BumpySolids scene(6);
    const Pose bInA = BumpySolids::at(25);
    const std::vector<TrackedContact> cuts = scene.cutsAt(bInA);
    ASSERT_FALSE(cuts.empty());
    const float nan = std::numeric_limits<float>::quiet_NaN();
    DepthMemory memory;
    const auto fault = [&](const SurfaceState& a, std::span<const TrackedContact> contacts,
                           const DepthSettings& settings, std::span<const ContactSides> sides = {}) {
        const DepthMemory before = memory;
        const DepthResult result = scene.query.measure(a, rigidState(bInA), contacts, sides, settings, memory);
        EXPECT_EQ(result.fault.has_value(), result.stop == StopReason::invalidInput);
        if (result.fault) {
            EXPECT_TRUE(result.regions.empty() && !result.complete);
            EXPECT_EQ(memory, before);
        }
        return result.fault;
    };
    EXPECT_EQ(fault({}, cuts, {}), std::nullopt);
    ASSERT_FALSE(memory.summits.empty());
    EXPECT_EQ(fault({}, cuts, {.spacing = -1}), Fault::badSetting);
    EXPECT_EQ(fault({}, cuts, {.spacing = nan}), Fault::badSetting);
    std::vector<ContactSides> sides(cuts.size() - 1);
    EXPECT_EQ(fault({}, cuts, {}, std::vector<ContactSides>(cuts.size() + 1)), Fault::badSetting);
    sides.push_back({0, 1});
    EXPECT_EQ(fault({}, cuts, {}, sides), Fault::badSetting);
    std::vector<TrackedContact> broken = cuts;
    broken[0].pair.triangleA = 1'000'000;
    EXPECT_EQ(fault({}, broken, {}), Fault::badSetting);
    broken = cuts;
    broken[0].onA[1] = nan;
    EXPECT_EQ(fault({}, broken, {}), Fault::notFinite);
    EXPECT_EQ(fault(rigidState({2 * Eigen::Matrix3f::Identity(), {0, 0, 0}}), cuts, {}), Fault::notRigid);
    std::vector<Eigen::Vector3f> moved = scene.a.surface.rest;
    EXPECT_EQ(fault({moved, {}, Stretch::measured(), {}}, cuts, {}), std::nullopt);
    moved[5][0] = nan;
    EXPECT_EQ(fault({moved, {}, Stretch::measured(), {}}, cuts, {}), Fault::notFinite);
    moved.assign(moved.size(), Eigen::Vector3f::Constant(nan));
    EXPECT_EQ(fault({moved, {}, Stretch::rigid(), {}}, cuts, {}), Fault::notFinite);
    moved.pop_back();
    EXPECT_EQ(fault({moved, {}, Stretch::measured(), {}}, cuts, {}), Fault::topologyChanged);
    memory.summits[0].vertex = 1'000'000;
    EXPECT_EQ(fault({}, cuts, {}), Fault::badSetting);
    DepthQuery self(scene.a);
    DepthMemory none;
    EXPECT_EQ(self.measure({}, cuts, {}, {}, none).fault, Fault::badSetting);  // no sides
}

TEST(DepthLaws, OddMeshesAreMeasuredAsFarAsTheyCanBe) {
    Random random(6);
    for (const scenes::Mesh& mesh : {soup(200, 0.4F, 5), needles(40), copiesOfOne(20)}) {
        const scenes::Mesh ball = scenes::sphere(0.4F, 4);
        SolidPair pair(mesh, ball);
        for (int pose = 0; pose < 10; ++pose) {
            const Pose bInA{random.rotation(), 0.5F * random.direction()};
            const DepthResult result = pair.measure(bInA, pair.cutsAt(bInA));
            EXPECT_TRUE(result.complete);
            for (const DepthRegion& region : result.regions) {
                EXPECT_NE(region.source, DepthSource::vertexOfB);  // nothing is inside of such
                EXPECT_LE(region.depth, 0.41F);
            }
        }
    }
}

}  // namespace
}  // namespace grapeshot::test
