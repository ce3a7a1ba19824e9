// Meshes against planes and convex solids within a budget: the laws of pair_update_test, for solids.
#include <grapeshot/narrowphase/solid_update.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string>

#include <Eigen/Geometry>

#include <grapeshot/narrowphase/pair_bytes.hpp>
#include <grapeshot/narrowphase/schedule.hpp>
#include <narrowphase/pair_states.hpp>
#include <scenes/shapes.hpp>
#include <support/poses.hpp>
#include <support/test_size.hpp>

namespace grapeshot {
namespace {

using Eigen::Vector3f;

/// A solid about its own origin, to be placed.
struct SolidKind {
    const char* name;
    float size;  ///< m: of a direction's extent
    std::function<std::unique_ptr<Solid>(const Pose&)> at;
};

const std::vector<SolidKind>& solids() {
    static const std::vector<SolidKind> all{
        {"plane", 0,
         [](const Pose& pose) -> std::unique_ptr<Solid> {
             const Vector3f normal = pose.rotation.col(1);
             return std::make_unique<PlacedPlane>(PlaneSolid{normal, normal.dot(pose.translation)});
         }},
        {"sphere", 0.3F,
         [](const Pose& pose) -> std::unique_ptr<Solid> {
             return std::make_unique<PlacedCapsule>(CapsuleSolid{pose.translation, pose.translation, 0.3F});
         }},
        {"capsule", 0.5F,
         [](const Pose& pose) -> std::unique_ptr<Solid> {
             const Vector3f half = 0.3F * pose.rotation.col(0);
             return std::make_unique<PlacedCapsule>(
                 CapsuleSolid{pose.translation - half, pose.translation + half, 0.2F});
         }},
        {"box", 0.3F,
         [](const Pose& pose) -> std::unique_ptr<Solid> {
             return std::make_unique<PlacedBox>(BoxSolid{pose, {0.3F, 0.2F, 0.25F}});
         }},
        {"floor", 0.4F,
         [](const Pose& pose) -> std::unique_ptr<Solid> {
             return std::make_unique<PlacedBox>(BoxSolid{pose, {5, 0.4F, 5}});
         }},
    };
    return all;
}

struct Body {
    const char* name;
    MeshModel model;
};

const std::vector<Body>& bodies() {
    static const std::vector<Body> all = [] {
        std::vector<Body> list;
        list.push_back({"torus", makeModel(scenes::torus(0.5F, 0.2F, 60, 30).view())});
        list.push_back({"bumpy", makeModel(scenes::bumpySphere(0.5F, 0.1F, 5, 14).view())});
        list.push_back({"table", makeModel(scenes::comb(4, 0.4F, 0.25F, 0.12F).view())});
        list.push_back({"block", makeModel(scenes::box({0.4F, 0.3F, 0.5F}, 12).view())});
        list.push_back({"sheet", makeModel(scenes::grid(0.6F, 0.6F, 24, 24).view())});
        return list;
    }();
    return all;
}

/// Near the mesh's lower side, more or less in it.
Pose somePose(const MeshModel& mesh, const SolidKind& solid, test::Random& random) {
    const Vector3f out = random.direction();
    Pose pose;
    pose.rotation = random.rotation();
    float lowest = 1e9F;
    for (const Vector3f& vertex : mesh.tree.vertices) {
        lowest = std::min(lowest, out.dot(vertex));
    }
    const float gap = static_cast<float>(random.uniform(-0.12, 0.04));
    if (solid.size == 0) {
        pose.rotation = Eigen::Quaternionf::FromTwoVectors(Vector3f::UnitY(), out).toRotationMatrix();
        pose.translation = out * (lowest - gap);
        return pose;
    }
    if (solid.name == std::string("floor")) {
        pose.rotation = Eigen::Quaternionf::FromTwoVectors(Vector3f::UnitY(), out).toRotationMatrix();
    }
    pose.translation = out * (lowest - gap - solid.size);
    return pose;
}

float deepestOf(const PairState& state) {
    float deepest = 1;
    for (const RegionSlot& slot : state.contacts.slots) {
        for (int i = 0; i < slot.count; ++i) {
            deepest = std::min(deepest, slot.points[static_cast<std::size_t>(i)].signedDistance);
        }
    }
    return deepest;
}

template <class Use>
void forEachPair(std::size_t poses, Use&& use) {
    for (const Body& body : bodies()) {
        for (const SolidKind& solid : solids()) {
            test::Random random(17);
            for (std::size_t i = 0; i < poses; ++i) {
                SCOPED_TRACE(std::string(body.name) + " on " + solid.name + ", pose " + std::to_string(i));
                const Pose pose = somePose(body.model, solid, random);
                use(body.model, solid, pose);
            }
        }
    }
}

TEST(SolidUpdate, MoreBudgetIsNeverWorseAndEnoughIsTheSameAsUnlimited) {
    std::size_t cutShort = 0;
    std::size_t touching = 0;
    forEachPair(test::sampleSize(4, 60), [&](const MeshModel& mesh, const SolidKind& kind, const Pose& pose) {
        const std::unique_ptr<Solid> solid = kind.at(pose);
        PairState whole;
        const PairResult all = updateSolid(mesh, *solid, pose, {}, {}, whole);
        ASSERT_TRUE(all.certain);
        touching += hasPoints(whole.contacts) ? 1 : 0;
        std::uint32_t before = 0;
        bool done = false;
        for (std::uint64_t work = 0; !done && work < 5000; work += 1 + work / 4) {
            PairState state;
            const PairResult result = updateSolid(mesh, *solid, pose, {}, {.work = work}, state);
            ASSERT_LE(result.work, work);
            EXPECT_GE(result.candidates, before) << "tested at " << work;
            before = result.candidates;
            done = result.certain;
            if (result.certain) {
                EXPECT_TRUE(test::sameContacts(state, whole)) << "at " << work;
                EXPECT_EQ(result.collides, all.collides);
                EXPECT_EQ(result.stop, StopReason::certain);
            } else {
                EXPECT_EQ(result.stop, StopReason::budget);
                ++cutShort;
            }
        }
        EXPECT_TRUE(done) << "whole: " << all.work;
    });
    EXPECT_GT(cutShort, 200U);
    EXPECT_GT(touching, 60U);
}

/// What a search slice finds at a first look is as deep as the whole, almost always.
TEST(SolidUpdate, ASearchSliceFindsTheDeepestPlace) {
    int touching = 0;
    int found = 0;
    int wrong = 0;
    forEachPair(test::sampleSize(12, 200), [&](const MeshModel& mesh, const SolidKind& kind, const Pose& pose) {
        const std::unique_ptr<Solid> solid = kind.at(pose);
        PairState whole;
        PairState state;
        updateSolid(mesh, *solid, pose, {}, {}, whole);
        updateSolid(mesh, *solid, pose, {}, {.work = 24}, state);
        if (deepestOf(whole) > 0) {
            return;
        }
        ++touching;
        found += deepestOf(state) < 0.8F * deepestOf(whole) + 1e-4F ? 1 : 0;
        wrong += deepestOf(state) < 1.25F * deepestOf(whole) - 0.01F ? 1 : 0;
    });
    EXPECT_GT(touching, 80);
    EXPECT_GT(found, touching * 9 / 10);
    EXPECT_LT(wrong, touching / 10);
}

TEST(SolidUpdate, WhatIsCutShortGoesOnInTheNextStep) {
    int touching = 0;
    int found = 0;
    int unheld = 0;
    forEachPair(test::sampleSize(2, 30), [&](const MeshModel& mesh, const SolidKind& kind, const Pose& pose) {
        const std::unique_ptr<Solid> solid = kind.at(pose);
        PairState whole;
        PairSettings settings;
        settings.slack = 0;
        updateSolid(mesh, *solid, pose, settings, {}, whole);
        PairState state;
        std::uint64_t steps = 0;
        while (state.candidateDistance < 0 && steps < 400) {
            EXPECT_LE(updateSolid(mesh, *solid, pose, settings, {.work = searchSlice}, state).work, searchSlice);
            ++steps;
        }
        ASSERT_GE(state.candidateDistance, 0) << "the traversal got to its end";
        for (std::size_t i = 0; i < 30 + state.candidates.size(); ++i) {
            updateSolid(mesh, *solid, pose, settings, {.work = searchSlice}, state);
        }
        const float deepest = deepestOf(whole);
        touching += deepest < 0 ? 1 : 0;
        found += deepest < 0 && deepestOf(state) < 0.8F * deepest + 1e-4F ? 1 : 0;
        unheld += deepest < -0.02F && deepestOf(state) > 0 ? 1 : 0;
        PairState last = state;
        EXPECT_TRUE(updateSolid(mesh, *solid, pose, settings, {}, last).certain);
    });
    EXPECT_GT(touching, 20);
    EXPECT_GE(found, touching * 95 / 100);
    EXPECT_LE(unheld, touching / 100);  // sheets that a box pierces between its corners
}

TEST(SolidUpdate, OutOfBudgetKeepsWhatItKnows) {
    const MeshModel block = makeModel(scenes::box({0.3F, 0.2F, 0.3F}, 4).view());
    const Pose flat{Eigen::Matrix3f::Identity(), {0, -0.2F, 0}};
    PairSettings settings;
    settings.set.regions.spacing = 0.7F;
    PairState state;
    updateSolid(block, PlacedPlane({Vector3f::UnitY(), -0.2F}), flat, settings, {}, state);
    ASSERT_EQ(state.contacts.slots.size(), 1U);
    ASSERT_EQ(state.contacts.slots[0].count, 4);
    const Pose lower{Eigen::Matrix3f::Identity(), {0, -0.199F, 0}};
    for (int i = 0; i < 5; ++i) {
        const PairResult result =
            updateSolid(block, PlacedPlane({Vector3f::UnitY(), -0.199F}), lower, settings, {.work = 0}, state);
        EXPECT_FALSE(result.certain);
        EXPECT_EQ(result.stop, StopReason::budget);
        EXPECT_EQ(result.work, 0U);
        EXPECT_TRUE(result.collides) << "the kept points say so";
    }
    EXPECT_EQ(state.contacts.slots[0].count, 4);
    EXPECT_NEAR(deepestOf(state), -0.001F, 1e-5F);
}

/// A path of many steps, from a copy and from bytes, under small and large slices.
TEST(SolidUpdate, ACopyAndSavedBytesGoOnTheSame) {
    bool searching = false;
    for (const Body& body : bodies()) {
        for (const SolidKind& kind : solids()) {
            SCOPED_TRACE(std::string(body.name) + " on " + kind.name);
            for (const std::uint64_t work : {std::uint64_t{6}, std::uint64_t{40}, unlimited}) {
                test::Random random(3);
                const Pose start = somePose(body.model, kind, random);
                PairState state;
                PairState loaded;
                for (int i = 0; i < 20; ++i) {
                    const Eigen::AngleAxisf turn(0.005F * static_cast<float>(i), Vector3f(0.2F, 1, 0.1F).normalized());
                    const Pose pose{turn.toRotationMatrix() * start.rotation, turn * start.translation};
                    const std::unique_ptr<Solid> solid = kind.at(pose);
                    std::vector<std::byte> bytes;
                    ByteWriter out(bytes);
                    save(state, out);
                    ByteReader in(bytes);
                    loaded = loadPairState(in, {&body.model, nullptr});
                    EXPECT_EQ(in.left(), 0U);
                    searching = searching || !state.openChildren.empty();
                    updateSolid(body.model, *solid, pose, {}, {.work = work}, state);
                    updateSolid(body.model, *solid, pose, {}, {.work = work}, loaded);
                    ASSERT_TRUE(test::sameContacts(state, loaded)) << i;
                    EXPECT_EQ(state.candidates, loaded.candidates);
                    EXPECT_EQ(state.openChildren, loaded.openChildren);
                }
            }
        }
    }
    EXPECT_TRUE(searching);
}

TEST(SolidUpdate, TimeIsASecondStopByTheGivenClock) {
    const MeshModel ball = makeModel(scenes::sphere(0.5F, 20).view());
    const Pose pose{Eigen::Matrix3f::Identity(), {0, -0.1F, 0}};
    const PlacedPlane plane({Vector3f::UnitY(), -0.1F});
    PairState whole;
    updateSolid(ball, plane, pose, {}, {}, whole);
    bool stopped = false;
    bool finished = false;
    for (const int us : {0, 5, 100, 100000}) {
        PairState state;
        const PairResult result =
            updateSolid(ball, plane, pose, {}, {.time = std::chrono::microseconds(us), .clock = test::tick}, state);
        (result.certain ? finished : stopped) = true;
        if (result.certain) {
            EXPECT_TRUE(test::sameContacts(state, whole));
        }
    }
    EXPECT_TRUE(stopped);
    EXPECT_TRUE(finished);
}

TEST(SolidUpdate, BadPosesReportNothing) {
    const MeshModel block = makeModel(scenes::box({0.3F, 0.2F, 0.3F}, 4).view());
    const Pose bad{Eigen::Matrix3f::Identity(), {0, std::nanf(""), 0}};
    PairState state;
    const PairResult result = updateSolid(block, PlacedPlane({Vector3f::UnitY(), -0.2F}), bad, {}, {.work = 20}, state);
    EXPECT_EQ(result.stop, StopReason::invalidInput);
    EXPECT_EQ(result.work, 0U);
    EXPECT_FALSE(hasPoints(state.contacts));
}

}  // namespace
}  // namespace grapeshot
