// Continuous steps of the tracker: all that touches at any moment, against the roots of cubics.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include <grapeshot/scf/detail/cells.hpp>
#include <grapeshot/scf/detail/track_motion.hpp>
#include <grapeshot/scf/tracker.hpp>

#include <adb/meshes.hpp>
#include <scf/continuous_scenes.hpp>
#include <scf/tracked_scenes.hpp>
#include <support/test_size.hpp>

namespace grapeshot::test {
namespace {

TrackSettings sweepSettings(TrackMode mode) {
    TrackSettings settings;
    settings.mode = mode;
    settings.spacing = 0.12F;
    settings.tolerance = 1e-6F;
    return settings;
}

TEST(TrackerSweep, ListsAllThatTouchesWhenItFirstDoes) {
    const PassingPair scene(3);
    Tracker tracker(scene.a, scene.b);
    std::size_t pairs = 0;
    std::size_t different = 0;
    for (std::uint64_t seed = 1; seed <= sampleSize(5, 30); ++seed) {
        const PassingPair::Event event = scene.event(seed);
        const TrackResult result = tracker.sweep(event.a.motion(), event.b.motion(), sweepSettings(TrackMode::exact));
        ASSERT_TRUE(result.certain);
        std::map<std::pair<std::uint32_t, std::uint32_t>, double> truth;
        for (const TriangleImpact& impact : allImpacts(event.a.exact(), event.b.exact())) {
            truth[{impact.a, impact.b}] = impact.time;
        }
        pairs += truth.size();
        std::size_t found = 0;
        for (const TrackedContact& contact : result.contacts) {
            const auto place = truth.find({contact.pair.triangleA, contact.pair.triangleB});
            if (place == truth.end()) {
                ++different;  // nearer than the tolerance, without touching
                continue;
            }
            ++found;
            EXPECT_LE(static_cast<double>(contact.time), place->second + 1e-4);
            // Early by what it takes to cover the tolerance, which along a surface is long.
            EXPECT_GE(static_cast<double>(contact.time), place->second - 0.02);
        }
        different += truth.size() - found;
    }
    EXPECT_GT(pairs, 200U);
    EXPECT_LE(different, pairs / 50);
}

TEST(TrackerSweep, AtResolutionEveryPairOfCellsThatMeetsIsListed) {
    const PassingPair scene(3);
    Tracker tracker(scene.a, scene.b);
    const TrackSettings settings = sweepSettings(TrackMode::resolution);
    const detail::Cells cellsA = detail::cellsOfRadius(scene.a, settings.spacing);
    const detail::Cells cellsB = detail::cellsOfRadius(scene.b, settings.spacing);
    std::size_t cells = 0;
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        tracker.clear();
        const PassingPair::Event event = scene.event(seed);
        const TrackResult result = tracker.sweep(event.a.motion(), event.b.motion(), settings);
        ASSERT_TRUE(result.certain);
        std::map<std::pair<std::uint32_t, std::uint32_t>, double> first;
        for (const TriangleImpact& impact : allImpacts(event.a.exact(), event.b.exact())) {
            const auto [place, isNew] =
                first.try_emplace({cellsA.idOf(scene.a, impact.a), cellsB.idOf(scene.b, impact.b)}, impact.time);
            place->second = std::min(place->second, impact.time);
        }
        std::set<std::pair<std::uint32_t, std::uint32_t>> reported;
        for (const TrackedContact& contact : result.contacts) {
            const std::pair key{cellsA.idOf(scene.a, contact.pair.triangleA),
                                cellsB.idOf(scene.b, contact.pair.triangleB)};
            EXPECT_TRUE(reported.insert(key).second) << "twice";
            if (const auto place = first.find(key); place != first.end()) {
                EXPECT_GE(static_cast<double>(contact.time), place->second - 0.02);
            }
        }
        for (const auto& [key, time] : first) {
            EXPECT_TRUE(reported.contains(key));
        }
        cells += first.size();
    }
    EXPECT_GT(cells, 50U);
}

TEST(TrackerSweep, ANeedleDoesNotPassThroughInAnyMode) {
    scenes::Mesh needle = scenes::sphere(1, 4);
    for (Eigen::Vector3f& vertex : needle.vertices) {
        vertex = {0.02F * vertex[0], 0.1F * vertex[1], 0.02F * vertex[2]};
    }
    const scenes::Mesh sheet = scenes::grid(1, 1, 30, 30);
    const BallTree a = buildBallTree(needle.view());
    const BallTree b = buildBallTree(sheet.view());
    Random random(2);
    for (int event = 0; event < 30; ++event) {
        const Pose above{random.rotation(), {static_cast<float>(random.uniform(-0.8, 0.8)), 0.4F, 0.1F}};
        const RigidMotion fall{above, {0, -1, 0}, {0, 0, static_cast<float>(random.uniform(-1, 1))}};
        for (const TrackMode mode : {TrackMode::exact, TrackMode::resolution, TrackMode::budget}) {
            Tracker tracker(a, b);
            TrackSettings settings = sweepSettings(mode);
            const TrackResult swept = tracker.sweep(rigidMotion(fall), rigidMotion(), settings);
            ASSERT_TRUE(swept.certain);
            ASSERT_FALSE(swept.contacts.empty());
            for (const TrackedContact& contact : swept.contacts) {
                EXPECT_GT(contact.time, 0.2F);
                EXPECT_LT(contact.time, 0.6F);
                EXPECT_NEAR(contact.onB[1], 0, 1e-4F);
            }
            for (const double time : {0.0, 1.0}) {
                const TrackResult discrete = tracker.step(rigidState(poseAt(fall, time)), rigidState(), settings);
                EXPECT_TRUE(discrete.contacts.empty());
            }
        }
    }
}

TEST(TrackerSweep, WithoutMotionItIsWhatIsInContact) {
    const TwoBumpy scene(12);
    const TwoBumpy::Frame where = scene.at(20);
    Tracker tracker(scene.a, scene.b);
    TrackSettings settings = TwoBumpy::settings(TrackMode::exact);
    const TrackResult still = tracker.step(where.stateA(), where.stateB(), settings);
    const TrackResult swept = tracker.sweep({where.a, where.a, {}, {}, {}}, {where.b, {}, {}, {}, {}}, settings);
    ASSERT_TRUE(still.certain && swept.certain);
    ASSERT_GT(still.contacts.size(), 20U);
    std::vector<TrianglePair> one;
    std::vector<TrianglePair> other;
    for (const TrackedContact& contact : still.contacts) {
        one.push_back(contact.pair);
        EXPECT_EQ(contact.time, 1);
    }
    for (const TrackedContact& contact : swept.contacts) {
        other.push_back(contact.pair);
        EXPECT_EQ(contact.time, 0);
    }
    std::ranges::sort(one);
    std::ranges::sort(other);
    std::vector<TrianglePair> different;
    std::ranges::set_symmetric_difference(one, other, std::back_inserter(different));
    EXPECT_LE(different.size(), one.size() / 100);  // within the tolerance
}

TEST(TrackerSweep, ContactsGoOnFromStepToStepAndFromDiscreteSteps) {
    const TwoBumpy scene(12);
    Tracker tracker(scene.a, scene.b);
    const TrackSettings settings = TwoBumpy::settings(TrackMode::budget);
    std::uint32_t oldest = 0;
    for (int frame = 12; frame < 24; ++frame) {
        const TwoBumpy::Frame from = scene.at(frame - 1);
        const TwoBumpy::Frame to = scene.at(frame);
        const TrackResult result = frame % 3 == 0 ? tracker.step(to.stateA(), to.stateB(), settings, {.work = 3000})
                                                  : tracker.sweep({from.a, to.a, {}, {}, {}},
                                                                  {from.b, to.b, {}, {}, {}}, settings, {.work = 3000});
        for (const TrackedContact& contact : result.contacts) {
            oldest = std::max(oldest, contact.age);
        }
    }
    EXPECT_GE(oldest, 8U);
    EXPECT_EQ(tracker.steps(), 12U);
}

TEST(TrackerSweep, ABudgetIsKeptAndWhatItLeavesIsNotDenied) {
    const PassingPair scene(8);
    std::size_t uncertain = 0;
    std::size_t held = 0;
    std::size_t judged = 0;
    for (std::uint64_t seed = 1; seed <= 12; ++seed) {
        const PassingPair::Event event = scene.event(seed);
        const TrackSettings settings = sweepSettings(TrackMode::budget);
        Tracker full(scene.a, scene.b);
        const TrackResult all = full.sweep(event.a.motion(), event.b.motion(), settings);
        ASSERT_TRUE(all.certain);
        for (const std::uint64_t work : {0U, 100U, 300U, 1000U, 3000U}) {
            Tracker tracker(scene.a, scene.b);
            const TrackResult result = tracker.sweep(event.a.motion(), event.b.motion(), settings, {.work = work});
            EXPECT_LE(result.work, work + 20);
            EXPECT_EQ(result.certain, result.stop == StopReason::certain);
            uncertain += result.certain ? 0 : 1;
            if (result.certain) {
                EXPECT_EQ(result.contacts.size(), all.contacts.size());
                EXPECT_EQ(result.miss.missedBound, 0);
            } else if (work > 0) {
                // Each missing pair of cells has an open pair at least, which the bound counts.
                ++judged;
                const auto missing =
                    static_cast<double>(all.contacts.size()) - static_cast<double>(result.contacts.size());
                held += missing == 0 || result.miss.missedBound > 0 ? 1 : 0;
            }
        }
    }
    EXPECT_GT(uncertain, 20U);
    EXPECT_EQ(held, judged);
}

/// One continuous step from nothing, and what its search leaves to the sample.
struct SweptStep {
    detail::MovingTree a, b;
    detail::TrackerScratch scratch;
    TrackResult out;

    SweptStep(const PassingPair& scene, const PassingPair::Event& event, const TrackSettings& settings,
              std::uint64_t work)
        : a(scene.a), b(scene.b), scratch(scene.a, scene.b, false) {
        scratch.spacingA = detail::cellsOfRadius(scene.a, settings.spacing);
        scratch.spacingB = detail::cellsOfRadius(scene.b, settings.spacing);
        a.begin(event.a.motion(), 2.5F, {});
        b.begin(event.b.motion(), 2.5F, {});
        const detail::ImpactSpace space{&a, &b, settings.maxDistance, settings.tolerance, -1};
        detail::Meter meter({.work = work});
        detail::TrackerMemory memory;
        detail::TrackMotion(space, settings, meter, memory, scratch, out).run({});
    }
};

/// The unit is an event; of each, many samples.
TEST(TrackerSweep, TheBoundOnWhatWasMissedHolds) {
    const PassingPair scene(4);
    TrackSettings settings = sweepSettings(TrackMode::budget);
    settings.auditShare = 0.4F;
    TrackSettings unsampled = settings;
    unsampled.auditShare = 0;
    const detail::Cells cellsA = detail::cellsOfRadius(scene.a, settings.spacing);
    const detail::Cells cellsB = detail::cellsOfRadius(scene.b, settings.spacing);
    const auto keyOf = [&](std::uint32_t triangleA, std::uint32_t triangleB) {
        return std::pair{cellsA.idOf(scene.a, triangleA), cellsB.idOf(scene.b, triangleB)};
    };
    std::vector<double> heldPerEvent;
    double missed = 0;
    double estimated = 0;
    double samples = 0;
    const std::size_t most = sampleSize(10, 40);
    for (std::uint64_t seed = 0; heldPerEvent.size() < most && seed < 8 * most; ++seed) {
        const PassingPair::Event event = scene.event(seed);
        const std::vector<TriangleImpact> all = allImpacts(event.a.exact(), event.b.exact());
        if (all.empty()) {
            continue;
        }
        const std::uint64_t work = 500 + 60 * (seed % 8);
        const auto spare =
            static_cast<std::uint64_t>(static_cast<double>(work) * static_cast<double>(settings.auditShare));
        const SweptStep search(scene, event, unsampled, work - spare);
        std::set<std::pair<std::uint32_t, std::uint32_t>> known;
        for (const TrackedContact& contact : search.out.contacts) {
            known.insert(keyOf(contact.pair.triangleA, contact.pair.triangleB));
        }
        std::vector<TriangleImpact> unknown = all;
        std::erase_if(unknown, [&](const TriangleImpact& impact) { return known.contains(keyOf(impact.a, impact.b)); });
        const auto truth = static_cast<double>(waitingWith(unknown, scene.a, scene.b, search.scratch.impact.front));
        double held = 0;
        constexpr int draws = 12;
        for (settings.seed = 1; settings.seed <= draws; ++settings.seed) {
            const MissEstimate miss = SweptStep(scene, event, settings, work).out.miss;
            ASSERT_EQ(miss.unknown, search.scratch.impact.front.size());
            ASSERT_LE(static_cast<double>(miss.hits), truth + 1);  // by the tolerance, one may touch that passes by
            held += truth - static_cast<double>(miss.hits) <= miss.missedBound ? 1 : 0;
            if (miss.open == 0 && miss.sampled > 0) {
                missed += truth - static_cast<double>(miss.hits);
                estimated += miss.missed;
                ++samples;
            }
        }
        heldPerEvent.push_back(held / draws);
    }
    ASSERT_EQ(heldPerEvent.size(), most);
    EXPECT_GT(missed, samples) << "there is little to miss";
    EXPECT_NEAR(estimated, missed, 0.15 * missed);
    double mean = 0;
    double squares = 0;
    for (const double held : heldPerEvent) {
        mean += held / static_cast<double>(most);
        squares += held * held / static_cast<double>(most);
    }
    const double error = std::sqrt(std::max(0.0, squares - mean * mean) / static_cast<double>(most - 1));
    EXPECT_GE(mean + 2 * error, 0.95) << "significantly below what is said";
}

TEST(TrackerSweep, OfABodyWithItself) {
    const Roll roll;
    Tracker tracker(roll.tree);
    TrackSettings settings = Roll::settings(TrackMode::exact);
    settings.maxDistance = 0.12F;
    const std::vector<Eigen::Vector3f> before = roll.at(2);
    const std::vector<Eigen::Vector3f> now = roll.at(6);
    const TrackResult swept = tracker.sweep({before, now, {}, {}, {}}, settings);
    ASSERT_TRUE(swept.certain);
    std::set<std::pair<std::uint32_t, std::uint32_t>> pairs;
    for (const TrackedContact& contact : swept.contacts) {
        EXPECT_LT(contact.pair.triangleA, contact.pair.triangleB);
        EXPECT_TRUE(pairs.insert({contact.pair.triangleA, contact.pair.triangleB}).second);
    }
    // Whatever is in contact at an end is so in between.
    for (const std::vector<Eigen::Vector3f>* end : {&before, &now}) {
        const TrackResult there = tracker.step({*end, {}, Stretch::measured(), {}}, settings);
        EXPECT_FALSE(there.contacts.empty());
        std::size_t missing = 0;
        for (const TrackedContact& contact : there.contacts) {
            missing += pairs.contains({contact.pair.triangleA, contact.pair.triangleB}) ? 0 : 1;
        }
        EXPECT_LE(missing, there.contacts.size() / 500);
    }
    const Pose turned{Eigen::Matrix3f(Eigen::AngleAxisf(1, Eigen::Vector3f::UnitX())), {1, 2, 3}};
    const TrackResult moved = tracker.sweep({before, now, {turned}, {}, {}}, settings);
    ASSERT_EQ(moved.contacts.size(), swept.contacts.size());
    EXPECT_LT((moved.contacts[0].onA - apply(turned, swept.contacts[0].onA)).norm(), 1e-5F);
}

TEST(TrackerSweep, SameBytesOnEveryInstructionSetAndFromASavedState) {
    const InstructionSetGuard guard;
    const TwoBumpy scene(12);
    std::vector<std::byte> first;
    for (const InstructionSet set : instructionSets()) {
        limitInstructionSet(set);
        Tracker tracker(scene.a, scene.b);
        std::vector<std::byte> all;
        for (int frame = 12; frame < 20; ++frame) {
            const TwoBumpy::Frame from = scene.at(frame - 1);
            const TwoBumpy::Frame to = scene.at(frame);
            const RigidMotion turn{{}, {0.01F, 0, 0}, {0.4F, 0, 0}};
            const auto bytes = bytesOf(tracker.sweep({from.a, to.a, {}, {}, {}}, {from.b, to.b, turn, {}, {}},
                                                     TwoBumpy::settings(TrackMode::budget), {.work = 2000}));
            all.insert(all.end(), bytes.begin(), bytes.end());
            Tracker loaded(scene.a, scene.b);
            loaded.load(tracker.save());
            tracker = loaded;
        }
        first = first.empty() ? all : first;
        EXPECT_EQ(all, first);
    }
    EXPECT_GT(first.size(), 2000U);
}

TEST(TrackerSweep, OddInputIsNamed) {
    const PassingPair scene(4);
    Tracker tracker(scene.a, scene.b);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const auto fault = [&](const SurfaceMotion& a, const TrackSettings& settings = {}) {
        const std::vector<std::byte> before = tracker.save();
        const TrackResult result =
            tracker.sweep(a, rigidMotion({{Eigen::Matrix3f::Identity(), {0.4F, 0, 0}}}), settings);
        EXPECT_EQ(result.fault.has_value(), result.stop == StopReason::invalidInput);
        if (result.fault) {
            EXPECT_TRUE(result.contacts.empty() && !result.certain);
            EXPECT_EQ(tracker.save(), before);
        }
        return result.fault;
    };
    EXPECT_EQ(fault(rigidMotion()), std::nullopt);
    EXPECT_EQ(fault(rigidMotion(), {.tolerance = 0}), Fault::badSetting);
    EXPECT_EQ(fault(rigidMotion(), {.tolerance = nan}), Fault::badSetting);
    EXPECT_EQ(fault(rigidMotion({{}, {nan, 0, 0}})), Fault::notFinite);
    EXPECT_EQ(fault(rigidMotion({{}, {0, 0, 0}, {1e6F, 0, 0}})), Fault::badSetting);
    EXPECT_EQ(fault(rigidMotion({{2 * Eigen::Matrix3f::Identity(), {0, 0, 0}}})), Fault::notRigid);
    std::vector<Eigen::Vector3f> moved = scene.meshA.vertices;
    moved[3][1] = nan;
    EXPECT_EQ(fault({scene.meshA.vertices, moved, {}, {}, {}}), Fault::notFinite);
    EXPECT_EQ(fault({moved, moved, {}, Stretch::rigid(), {}}), Fault::notFinite);
    moved.pop_back();
    EXPECT_EQ(fault({moved, {}, {}, {}, {}}), Fault::topologyChanged);
    const TrackResult none = tracker.sweep(rigidMotion(), rigidMotion(), {}, {.work = 0});
    EXPECT_EQ(none.stop, StopReason::budget);
    EXPECT_TRUE(none.contacts.empty() && !none.certain);
    EXPECT_EQ(none.carried, none.tracked);
}

}  // namespace
}  // namespace grapeshot::test
