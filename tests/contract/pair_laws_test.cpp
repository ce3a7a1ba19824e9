// Laws of the pair state: what persists from step to step.
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <tuple>

#include <grapeshot/core/instruction_set.hpp>
#include <grapeshot/narrowphase/pair_update.hpp>

#include "law_samples.hpp"

namespace grapeshot::test {
namespace {

using Bytes = std::vector<std::uint32_t>;

void append(Bytes& bytes, const Eigen::Vector3f& v) {
    for (int axis = 0; axis < 3; ++axis) {
        bytes.push_back(std::bit_cast<std::uint32_t>(v[axis]));
    }
}

/// All that a state reports and keeps, number by number.
Bytes bytesOf(const PairState& state, const PairResult& result) {
    Bytes bytes{result.collides,
                result.certain,
                static_cast<std::uint32_t>(result.work),
                result.candidates,
                result.traversed,
                result.rawContacts,
                result.deepContacts,
                state.contacts.nextId,
                state.contacts.droppedRegions,
                std::bit_cast<std::uint32_t>(state.candidateDistance)};
    for (const LeafPair& pair : state.candidates) {
        bytes.push_back(pair.leafA);
        bytes.push_back(pair.leafB);
    }
    for (const RegionSlot& slot : state.contacts.slots) {
        bytes.push_back(slot.id);
        if (slot.id == 0) {
            continue;
        }
        append(bytes, slot.normalInB);
        append(bytes, slot.centerInA);
        bytes.push_back(std::bit_cast<std::uint32_t>(slot.depth));
        for (int i = 0; i < slot.count; ++i) {
            const PersistentPoint& point = slot.points[static_cast<std::size_t>(i)];
            append(bytes, point.localA);
            append(bytes, point.localB);
            append(bytes, point.normalInB);
            bytes.push_back(std::bit_cast<std::uint32_t>(point.signedDistance));
            bytes.insert(bytes.end(), {point.triangleA, point.triangleB, point.age});
        }
    }
    return bytes;
}

constexpr int steps = 150;

/// A method, and how much it may leave to chance.
struct Way {
    const char* name;
    Method method;
    std::uint64_t searchWork;
};
constexpr std::array ways{Way{"Automatic", Method::automatic, unlimited}, Way{"Adb", Method::adb, unlimited},
                          Way{"Scf", Method::scf, unlimited}, Way{"ScfSampled", Method::scf, 160}};
constexpr Way sampled = ways[3];

PairSettings settingsOf(const Way& way) {
    PairSettings settings;
    settings.method = way.method;
    settings.features.searchWork = way.searchWork;
    return settings;
}

using Sample = std::tuple<std::size_t, Way>;

class PairLaws : public testing::TestWithParam<Sample> {
  protected:
    LawPair pair = lawPairs()[std::get<0>(GetParam())];
    PairSettings settings = settingsOf(std::get<1>(GetParam()));
    MeshModel a = makeTrackedModel(pair.a.view());
    MeshModel b = makeTrackedModel(pair.b.view());
    std::vector<Pose> path = lawPath(a.tree, b.tree, steps, 13);

    std::vector<Bytes> walk(PairState& state, std::size_t from, std::size_t to, Budget budget = {}) const {
        std::vector<Bytes> history;
        for (std::size_t i = from; i < to; ++i) {
            const PairResult result = update(a, b, path[i], settings, budget, state);
            history.push_back(bytesOf(state, result));
        }
        return history;
    }
};

TEST_P(PairLaws, ThePathIsRepresentative) {
    PairState state;
    int touching = 0;
    std::size_t contacts = 0;
    for (const Pose& pose : path) {
        touching += update(a, b, pose, settings, {}, state).collides ? 1 : 0;
        contacts += state.contacts.slots.size();
    }
    EXPECT_GT(touching, steps / 10);
    EXPECT_LT(touching, steps);
    EXPECT_GT(contacts, static_cast<std::size_t>(steps) / 5);
}

TEST_P(PairLaws, EveryInstructionSetAndEveryRunGiveTheSameBytes) {
    const InstructionSet best = instructionSet();
    for (const Budget budget : {Budget{}, Budget{.work = 20}}) {
        PairState first;
        const auto reference = walk(first, 0, path.size(), budget);
        for (const InstructionSet set : {best, InstructionSet::scalar, InstructionSet::avx2, InstructionSet::avx512}) {
            limitInstructionSet(set);
            SCOPED_TRACE(name(instructionSet()));
            PairState state;
            EXPECT_EQ(walk(state, 0, path.size(), budget), reference);
        }
        limitInstructionSet(best);
    }
}

TEST_P(PairLaws, ACopiedStateGoesOnLikeTheOriginal) {
    PairState whole;
    const auto reference = walk(whole, 0, path.size());
    for (const std::size_t stop : {path.size() / 3, path.size() / 2, path.size() * 4 / 5}) {
        PairState before;
        walk(before, 0, stop);
        PairState restored = before;
        walk(before, stop, path.size());  // what happens to the original is no matter to the copy
        const auto after = walk(restored, stop, path.size());
        EXPECT_TRUE(std::equal(after.begin(), after.end(), reference.begin() + static_cast<std::ptrdiff_t>(stop)));
    }
}

TEST_P(PairLaws, KeptCandidatesChangeNoContact) {
    if (settings.features.searchWork != unlimited) {
        GTEST_SKIP() << "what is sampled depends on what was known";
    }
    PairSettings everyStep = settings;
    everyStep.slack = 0;
    PairSettings seldom = settings;
    seldom.slack = 0.15F;
    PairState kept;
    PairState fresh;
    int skipped = 0;
    for (const Pose& pose : path) {
        const PairResult one = update(a, b, pose, seldom, {}, kept);
        const PairResult other = update(a, b, pose, everyStep, {}, fresh);
        skipped += one.traversed ? 0 : 1;
        EXPECT_EQ(one.collides, other.collides);
        EXPECT_EQ(one.rawContacts, other.rawContacts);
        EXPECT_EQ(kept.contacts.slots.size(), fresh.contacts.slots.size());
    }
    EXPECT_GT(skipped, steps / 3);
}

TEST_P(PairLaws, NoContactIsEverNotFinite) {
    PairState state;
    Random random(3);
    for (const Pose& pose : lawPoses(a.tree, b.tree, 150, 17)) {
        update(a, b, pose, settings, {}, state);
        for (const RegionSlot& slot : state.contacts.slots) {
            for (int i = 0; slot.id != 0 && i < slot.count; ++i) {
                const PersistentPoint& point = slot.points[static_cast<std::size_t>(i)];
                EXPECT_TRUE(point.localA.allFinite() && point.localB.allFinite());
                EXPECT_TRUE(std::isfinite(point.signedDistance));
                EXPECT_NEAR(point.normalInB.norm(), 1.0F, 1e-3F);
            }
        }
    }
}

TEST_P(PairLaws, ABadPoseClearsAndTheNextGoodOneRecovers) {
    PairState state;
    walk(state, 0, path.size());
    Pose bad = path.back();
    bad.translation.z() = std::numeric_limits<float>::quiet_NaN();
    const PairResult result = update(a, b, bad, settings, {}, state);
    EXPECT_EQ(result.stop, StopReason::invalidInput);
    EXPECT_FALSE(result.collides);
    for (const RegionSlot& slot : state.contacts.slots) {
        EXPECT_TRUE(slot.id == 0 || slot.count == 0);
    }
    PairState fresh;
    EXPECT_EQ(update(a, b, path.back(), settings, {}, state).collides,
              update(a, b, path.back(), settings, {}, fresh).collides);
}

INSTANTIATE_TEST_SUITE_P(AllPairs, PairLaws,
                         testing::Combine(testing::Range(std::size_t{0}, std::size_t{4}), testing::ValuesIn(ways)),
                         [](const auto& sample) {
                             return lawPairs()[std::get<0>(sample.param)].name + std::get<1>(sample.param).name;
                         });

/// Laws from one method to another.
class MethodLaws : public testing::TestWithParam<std::size_t> {
  protected:
    LawPair pair = lawPairs()[GetParam()];
    MeshModel a = makeTrackedModel(pair.a.view());
    MeshModel b = makeTrackedModel(pair.b.view());
    std::vector<Pose> path = lawPath(a.tree, b.tree, steps, 13);
};

TEST_P(MethodLaws, WithoutALimitAllGiveTheSameContacts) {
    std::array<PairState, 3> states;
    for (const Pose& pose : path) {
        std::array<Bytes, 3> found;
        for (std::size_t i = 0; i < states.size(); ++i) {
            const PairResult result = update(a, b, pose, settingsOf(ways[i]), {}, states[i]);
            EXPECT_TRUE(result.certain);
            EXPECT_EQ(result.method, ways[i].method == Method::scf ? Method::scf : Method::adb);
            PairState contacts;
            contacts.contacts = states[i].contacts;
            PairResult same;
            same.collides = result.collides;
            same.rawContacts = result.rawContacts;
            same.deepContacts = result.deepContacts;
            found[i] = bytesOf(contacts, same);
        }
        EXPECT_EQ(found[1], found[0]);
        EXPECT_EQ(found[2], found[0]);
    }
}

TEST_P(MethodLaws, AModelWithoutFeaturesIsLeftToAdb) {
    const MeshModel plain = makeModel(pair.b.view());
    PairState asked;
    PairState adb;
    for (const Pose& pose : path) {
        const PairResult one = update(a, plain, pose, settingsOf(ways[2]), {}, asked);
        const PairResult other = update(a, plain, pose, settingsOf(ways[1]), {}, adb);
        EXPECT_EQ(one.method, Method::adb);
        EXPECT_EQ(bytesOf(asked, one), bytesOf(adb, other));
    }
}

/// What is sampled says so, and misses little.
TEST_P(MethodLaws, SamplesSayThatTheyAreNotCertain) {
    PairState state;
    PairState exact;
    int sampledSteps = 0;
    int missed = 0;
    int colliding = 0;
    for (const Pose& pose : path) {
        const PairResult one = update(a, b, pose, settingsOf(sampled), {}, state);
        const PairResult truth = update(a, b, pose, settingsOf(ways[1]), {}, exact);
        sampledSteps += one.sampled ? 1 : 0;
        EXPECT_NE(one.certain, one.sampled);
        EXPECT_EQ(one.stop, one.sampled ? StopReason::probability : StopReason::certain);
        EXPECT_GE(one.missBound, 0);
        EXPECT_TRUE(one.sampled || one.missBound == 0);
        colliding += truth.collides ? 1 : 0;
        missed += truth.collides && !one.collides ? 1 : 0;
        EXPECT_TRUE(truth.collides || !one.collides) << "what does not touch is not found";
    }
    EXPECT_GT(sampledSteps, steps / 10) << "nothing is ever sampled";
    EXPECT_LE(missed, 1 + colliding / 50);
}

INSTANTIATE_TEST_SUITE_P(AllPairs, MethodLaws, testing::Range(std::size_t{0}, std::size_t{4}),
                         [](const auto& sample) { return lawPairs()[sample.param].name; });

}  // namespace
}  // namespace grapeshot::test
