// Laws of the pair state: what persists from step to step.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <tuple>

#include <grapeshot/core/instruction_set.hpp>
#include <grapeshot/narrowphase/pair_update.hpp>
#include <support/oracle.hpp>

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

/// Every 15th pose of the path, each asked of a state without memory.
constexpr std::size_t everySo = 15;

/// A contact stands on both surfaces, on the triangles that it names, and they are as near as it says.
TEST_P(PairLaws, EveryContactStandsOnGeometry) {
    int points = 0;
    for (std::size_t i = 0; i < path.size() && points <= 20; i += 2) {
        PairState state;
        update(a, b, path[i], settings, {}, state);
        for (const RegionSlot& slot : state.contacts.slots) {
            for (int k = 0; slot.id != 0 && k < slot.count; ++k) {
                const PersistentPoint& point = slot.points[static_cast<std::size_t>(k)];
                if (point.signedDistance < -0.02F) {
                    continue;  // of a cut: its ends are in the middle of the common volume
                }
                ++points;
                const auto offSurface = [](const scenes::Mesh& mesh, std::uint32_t triangle,
                                           const Eigen::Vector3f& at) {
                    const Corners corners = cornersOf(mesh.view(), triangle);
                    const Eigen::Vector3d p = at.cast<double>();
                    return triangleDistance(corners, {p, p, p});
                };
                EXPECT_LT(offSurface(pair.a, point.triangleA, point.localA), 0.021) << "step " << i;
                EXPECT_LT(offSurface(pair.b, point.triangleB, point.localB), 0.021) << "step " << i;
                const double apart = triangleDistance(cornersOf(pair.a.view(), point.triangleA),
                                                      cornersOf(pair.b.view(), point.triangleB, path[i]));
                EXPECT_LE(apart, std::abs(point.signedDistance) + 1e-3) << "step " << i;
            }
        }
    }
    EXPECT_GT(points, 3);
}

TEST_P(PairLaws, SwappedBodiesFindTheSame) {
    for (std::size_t i = 0; i < path.size(); i += everySo) {
        PairState forth;
        PairState back;
        const PairResult one = update(a, b, path[i], settings, {}, forth);
        const PairResult other = update(b, a, inverse(path[i]), settings, {}, back);
        if (one.sampled || other.sampled) {
            continue;  // drawn in another order
        }
        EXPECT_EQ(one.collides, other.collides) << "step " << i;
        EXPECT_EQ(one.rawContacts, other.rawContacts) << "step " << i;
        EXPECT_EQ(one.method, other.method);
    }
}

TEST_P(PairLaws, ARigidMotionOfBothChangesNothing) {
    Random random(31);
    const Pose motion{random.rotation(), random.direction()};
    const MeshModel moved = makeTrackedModel(movedBy(pair.a, motion).view());
    for (std::size_t i = 0; i < path.size(); i += everySo) {
        PairState before;
        PairState after;
        const PairResult one = update(a, b, path[i], settings, {}, before);
        const PairResult other = update(moved, b, compose(motion, path[i]), settings, {}, after);
        if (one.sampled || other.sampled) {
            continue;
        }
        EXPECT_EQ(one.collides, other.collides) << "step " << i;
        EXPECT_NEAR(one.rawContacts, other.rawContacts, 1 + one.rawContacts / 50) << "step " << i;
    }
}

TEST_P(PairLaws, MoreBudgetIsNeverWorseAndEnoughIsTheSameAsUnlimited) {
    for (std::size_t i = 0; i < path.size(); i += 2 * everySo) {
        PairState whole;
        const PairResult all = update(a, b, path[i], settings, {}, whole);
        std::uint32_t before = 0;
        for (std::uint64_t work = 0; work <= 2 * all.work + 2; work += 1 + work / 2) {
            PairState state;
            const PairResult result = update(a, b, path[i], settings, {.work = work}, state);
            EXPECT_LE(result.work, work) << "step " << i;
            if (result.sampled) {
                continue;
            }
            EXPECT_GE(result.candidates, before) << "step " << i << ", tested at " << work;
            before = result.candidates;
            if (result.certain) {
                EXPECT_EQ(result.collides, all.collides) << "step " << i;
                EXPECT_EQ(result.rawContacts, all.rawContacts) << "step " << i;
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

/// What bruteForceClearance says, but of pairs of triangles whose boxes are within `reach` alone: beyond, infinity.
double clearanceWithin(const LawPair& pair, const Pose& bInA, double reach) {
    struct Boxed {
        Corners corners;
        Eigen::AlignedBox3d box;
    };
    const auto boxed = [](const scenes::Mesh& mesh, const Pose& pose) {
        std::vector<Boxed> all;
        for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
            Boxed one{cornersOf(mesh.view(), t, pose), {}};
            for (const Eigen::Vector3d& corner : one.corners) {
                one.box.extend(corner);
            }
            all.push_back(one);
        }
        return all;
    };
    const std::vector<Boxed> ofA = boxed(pair.a, {});
    const std::vector<Boxed> ofB = boxed(pair.b, bInA);
    double nearest = std::numeric_limits<double>::infinity();
    double deepest = 0;
    for (const Boxed& x : ofA) {
        for (const Boxed& y : ofB) {
            if (x.box.squaredExteriorDistance(y.box) > reach * reach) {
                continue;
            }
            if (trianglesOverlap(x.corners, y.corners)) {
                deepest = std::max(deepest, triangleSeparation(x.corners, y.corners));
                nearest = 0;
            } else {
                nearest = std::min(nearest, triangleDistance(x.corners, y.corners));
            }
        }
    }
    return nearest == 0 ? -deepest : nearest;
}

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

TEST_P(MethodLaws, ContactsAreThereByTheOracleAndNoneIsMissed) {
    int judged = 0;
    int near = 0;
    for (std::size_t i = 0; i < path.size(); i += everySo) {
        const auto reach = static_cast<double>(PairSettings{}.maxDistance);
        const double clearance = clearanceWithin(pair, path[i], reach + 1e-4);
        if (std::abs(clearance) < 1e-4 || std::abs(clearance - reach) < 1e-4) {
            continue;
        }
        ++judged;
        near += clearance < reach ? 1 : 0;
        for (const Way& way : ways) {
            SCOPED_TRACE(way.name);
            PairSettings settings = settingsOf(way);
            settings.interior = Interior::surface;
            PairState state;
            const PairResult result = update(a, b, path[i], settings, {}, state);
            EXPECT_TRUE(!result.collides || clearance < 0) << "step " << i << ", apart by " << clearance;
            EXPECT_TRUE(result.rawContacts + result.deepContacts == 0 || clearance < reach)
                << "no geometry is near, step " << i;
            if (!result.sampled) {  // what a sample leaves out is bounded elsewhere
                EXPECT_EQ(result.collides, clearance < 0) << "step " << i << ", clearance " << clearance;
                EXPECT_EQ(result.rawContacts + result.deepContacts > 0, clearance < reach) << "step " << i;
            }
        }
    }
    EXPECT_GT(judged, 5);
    EXPECT_GT(near, 2);
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
