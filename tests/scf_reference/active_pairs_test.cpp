// What holds after a step, whatever the settings; and what each setting does.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <grapeshot/core/instruction_set.hpp>
#include <grapeshot/scf/reference/active_pairs.hpp>
#include <support/fault_of.hpp>
#include <support/oracle.hpp>
#include "bodies.hpp"

namespace grapeshot::scf::reference {
namespace {

using test::approach;
using test::approachSteps;
using test::bodies;
using test::distanceAt;
using test::History;

using Pairs = std::set<std::pair<std::uint32_t, std::uint32_t>>;

Pairs pairsOf(const StepResult& result) {
    Pairs pairs;
    for (const Contact& contact : result.contacts) {
        pairs.emplace(contact.triangleA, contact.triangleB);
    }
    return pairs;
}

Pairs truePairs(float distance, double maxDistance) {
    const std::vector<Eigen::Vector3f> b = bodies().atB(distance);
    const MeshView viewA{bodies().atA, bodies().mesh.triangles};
    Pairs pairs;
    for (const TrianglePair& pair : test::bruteForcePairs(viewA, {b, bodies().mesh.triangles}, {}, maxDistance)) {
        pairs.emplace(pair.triangleA, pair.triangleB);
    }
    return pairs;
}

double trueDistance(float distance) {
    const std::vector<Eigen::Vector3f> b = bodies().atB(distance);
    return std::max(
        0.0, test::bruteForceClearance({bodies().atA, bodies().mesh.triangles}, {b, bodies().mesh.triangles}, {}));
}

TEST(ActivePairs, ReportOnlyWhatIsThere) {
    Settings settings;
    settings.maxDistance = 0.004F;
    settings.spread = true;
    std::size_t reported = 0;
    State state;
    for (int i = 0; i < approachSteps; ++i) {
        const StepResult result = bodies().step(settings, state, distanceAt(i));
        const Pairs found = pairsOf(result);
        EXPECT_EQ(found.size(), result.contacts.size()) << "each pair once";
        const Pairs truth = truePairs(distanceAt(i), 0.004 + 1e-6);
        EXPECT_TRUE(std::ranges::includes(truth, found));
        reported += found.size();
    }
    EXPECT_GT(reported, 50U);
}

TEST(ActivePairs, FindTheDistanceFromAboveAndWithManyPairsExactly) {
    int exact = 0;
    for (int i = 0; i < 5; ++i) {
        const double truth = trueDistance(distanceAt(i));
        for (const int newPairs : {1, 300}) {
            Settings settings = withoutHierarchy();
            settings.newPairs = newPairs;
            settings.seed = static_cast<std::uint64_t>(i);
            State state;
            const float closest = bodies().step(settings, state, distanceAt(i)).closest;
            EXPECT_GE(closest, truth - 1e-6);
            exact += newPairs == 300 && closest < truth + 1e-6 ? 1 : 0;
        }
    }
    EXPECT_GE(exact, 4);
}

TEST(ActivePairs, FollowAContactWithoutNewOnes) {
    Settings settings;
    State state;
    ASSERT_FALSE(bodies().step(settings, state, 1.1F).contacts.empty());
    settings.newPairs = 0;
    int seen = 0;
    for (int i = 0; i < 20; ++i) {
        seen += bodies().step(settings, state, 1.1F - 0.002F * static_cast<float>(i)).contacts.empty() ? 0 : 1;
    }
    EXPECT_EQ(seen, 20);
    State empty;
    const StepResult nothing = bodies().step(settings, empty, 1.1F);
    EXPECT_TRUE(nothing.contacts.empty());
    EXPECT_EQ(nothing.closest, std::numeric_limits<float>::infinity());
}

TEST(ActivePairs, AreAFunctionOfSeedStateAndInput) {
    for (const Settings& base : {withHierarchy(), withoutHierarchy()}) {
        Settings settings = base;
        settings.velocityShare = 1 - settings.hierarchyShare;
        const History first = approach(bodies(), settings);
        const History again = approach(bodies(), settings);
        EXPECT_EQ(first.state, again.state);
        EXPECT_EQ(first.results, again.results);
        settings.seed = 2;
        EXPECT_NE(approach(bodies(), settings).state, first.state);
        settings.seed = 1;
        settings.pair = 2;
        EXPECT_NE(approach(bodies(), settings).state, first.state);
    }
}

TEST(ActivePairs, KeepTheOldOfTwoAtOneMinimum) {
    const Settings settings;
    State state;
    for (int i = 0; i < 6; ++i) {
        bodies().step(settings, state, 1.1F);
    }
    EXPECT_GT(std::ranges::count(state.pairs, 6U, &ActivePair::age), 3);
}

TEST(ActivePairs, GoBackToACopiedState) {
    const Settings settings;
    State state;
    bodies().step(settings, state, 1.2F);
    const State kept = state;
    const StepResult once = bodies().step(settings, state, 1.15F);
    const State after = state;
    state = kept;
    EXPECT_EQ(pairsOf(bodies().step(settings, state, 1.15F)), pairsOf(once));
    EXPECT_EQ(state, after);
}

TEST(ActivePairs, AreTheSameOnEveryInstructionSet) {
    const InstructionSet best = instructionSet();
    const State wide = approach(bodies(), {}).state;
    for (const InstructionSet set : {InstructionSet::scalar, InstructionSet::avx2}) {
        limitInstructionSet(set);
        EXPECT_EQ(approach(bodies(), {}).state, wide);
    }
    limitInstructionSet(best);
}

/// No neighbour at one end is closer; with the full update none at both.
TEST(ActivePairs, EndAtLocalMinima) {
    for (const Update update : {Update::twoStep, Update::full}) {
        Settings settings = withoutHierarchy();
        settings.update = update;
        settings.removeFar = false;
        State state;
        bodies().step(settings, state, 1.3F);
        const std::vector<Eigen::Vector3f> atB = bodies().atB(1.3F);
        const Level& level = bodies().a.levels[0];
        const auto distance = [&](std::uint32_t a, std::uint32_t b) {
            return (bodies().atA[level.centre[a]] - atB[level.centre[b]]).squaredNorm();
        };
        ASSERT_GT(state.pairs.size(), 3U);
        for (const ActivePair& pair : state.pairs) {
            const float own = distance(pair.a, pair.b);
            for (const std::uint32_t a : level.ring[pair.a]) {
                EXPECT_GE(distance(a, pair.b), own);
                for (const std::uint32_t b : level.ring[pair.b]) {
                    EXPECT_GE(distance(pair.a, b), own);
                    if (update == Update::full) {
                        EXPECT_GE(distance(a, b), own);
                    }
                }
            }
        }
    }
}

TEST(ActivePairs, TwoStepsCostTheSumOfTheNeighboursNotTheProduct) {
    Settings settings = withoutHierarchy();
    State state;
    const Work twoStep = bodies().step(settings, state, 1.3F).work;
    settings.update = Update::full;
    State other;
    const Work full = bodies().step(settings, other, 1.3F).work;
    const auto perMove = [](const Work& work) {
        return static_cast<double>(work.featureDistances) / static_cast<double>(work.moves + work.created);
    };
    EXPECT_LT(perMove(twoStep), 16);
    EXPECT_GT(perMove(full), 40);
}

TEST(ActivePairs, FarAndRedundantOnesGo) {
    for (const bool contact : {false, true}) {
        const float distance = contact ? 1.1F : 1.35F;
        Settings settings = withoutHierarchy();
        settings.removeFar = false;
        settings.redundancy = Redundancy::none;
        State all;
        bodies().step(settings, all, distance);
        EXPECT_EQ(all.pairs.size(), 50U);
        settings.redundancy = Redundancy::samePair;
        State once;
        bodies().step(settings, once, distance);
        std::set<std::pair<std::uint32_t, std::uint32_t>> keys;
        for (const ActivePair& pair : once.pairs) {
            EXPECT_TRUE(keys.emplace(pair.a, pair.b).second);
        }
        EXPECT_LT(once.pairs.size(), all.pairs.size());
        settings.redundancy = Redundancy::neighbours;
        State apart;
        bodies().step(settings, apart, distance);
        EXPECT_LE(apart.pairs.size(), once.pairs.size());
        settings.redundancy = Redundancy::samePair;
        settings.removeFar = true;
        State near;
        const StepResult result = bodies().step(settings, near, distance);
        EXPECT_LT(near.pairs.size(), once.pairs.size());
        EXPECT_EQ(result.work.far, once.pairs.size() - near.pairs.size());
        const auto size = 2.0F;  // of both boxes: one is turned, so a little more at most
        for (const ActivePair& pair : near.pairs) {
            EXPECT_LE(pair.distance, 1.2F * result.closest + 0.013F * size);
        }
    }
}

TEST(ActivePairs, NeighboursAreSuppressedByTheClosest) {
    Settings settings;
    settings.mostMoves = 1;
    settings.redundancy = Redundancy::neighbours;
    State state;
    bodies().step(settings, state, 1.05F);
    ASSERT_GT(state.pairs.size(), 2U);
    const Lists& ring = bodies().a.levels[0].ring;
    const auto close = [&ring](std::uint32_t x, std::uint32_t y) {
        return x == y || std::ranges::count(ring[x], y) > 0;
    };
    for (const ActivePair& x : state.pairs) {
        for (const ActivePair& y : state.pairs) {
            EXPECT_TRUE(&x == &y || !close(x.a, y.a) || !close(x.b, y.b));
        }
    }
}

TEST(ActivePairs, AHitSpreadsOverItsPatch) {
    Settings settings;
    settings.maxDistance = 0.005F;
    State state;
    const Pairs alone = pairsOf(bodies().step(settings, state, 1.0F));
    settings.spread = true;
    State other;
    const StepResult result = bodies().step(settings, other, 1.0F);
    const Pairs patch = pairsOf(result);
    EXPECT_EQ(state, other) << "the response covers the patch; the list of pairs stays what it is";
    EXPECT_TRUE(std::ranges::includes(patch, alone));
    EXPECT_GT(patch.size(), 3 * alone.size());
    // Most triangles in contact are in the patch, of either body.
    const Pairs truth = truePairs(1.0F, 0.005);
    const auto count = [](const Pairs& pairs, auto member) {
        std::set<std::uint32_t> triangles;
        for (const auto& pair : pairs) {
            triangles.insert(pair.*member);
        }
        return triangles.size();
    };
    using Pair = Pairs::value_type;
    EXPECT_GT(count(patch, &Pair::first), count(truth, &Pair::first) * 2 / 3);
    EXPECT_GT(count(patch, &Pair::second), count(truth, &Pair::second) * 2 / 3);
    settings.mostSpread = 7;
    State third;
    EXPECT_EQ(bodies().step(settings, third, 1.0F).work.spread, 7U);
}

TEST(ActivePairs, StayCoarseWhileFarAndBecomeFineWhenNear) {
    Settings settings = withoutHierarchy();
    settings.multires = true;
    settings.removeFar = false;
    State state;
    bodies().step(settings, state, 8);
    ASSERT_FALSE(state.pairs.empty());
    const auto coarsest = static_cast<std::uint8_t>(bodies().a.levels.size() - 1);
    ASSERT_GE(coarsest, 1);
    for (const ActivePair& pair : state.pairs) {
        EXPECT_EQ(pair.level, coarsest);
    }
    settings.newPairs = 0;
    bodies().step(settings, state, 1.1F);
    EXPECT_EQ(state.pairs.front().level, 0);
    EXPECT_EQ(state.pairs.front().distance, 0) << "a pair kept from afar has found the contact";
    bodies().step(settings, state, 8);
    for (const ActivePair& pair : state.pairs) {
        EXPECT_EQ(pair.level, coarsest);
    }
}

TEST(ActivePairs, BadInputIsNamedAndLeavesTheState) {
    State state;
    bodies().step({}, state, 1.1F);
    const State before = state;
    const auto fault = [&](const std::vector<Eigen::Vector3f>& a, const std::vector<Eigen::Vector3f>& b) {
        return test::faultOf([&] { step(bodies().a, bodies().b, a, b, {}, state); });
    };
    const std::vector<Eigen::Vector3f> good = bodies().atA;
    std::vector<Eigen::Vector3f> fewer = good;
    fewer.pop_back();
    EXPECT_EQ(fault(fewer, good), Fault::topologyChanged);
    EXPECT_EQ(fault(good, fewer), Fault::topologyChanged);
    for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        std::vector<Eigen::Vector3f> broken = good;
        broken[17].z() = bad;
        EXPECT_EQ(fault(broken, good), Fault::notFinite);
        EXPECT_EQ(fault(good, broken), Fault::notFinite);
    }
    EXPECT_EQ(state, before);
    const scenes::Mesh box = scenes::box({1, 1, 1});
    const Surface other = buildSurface(box.view());
    EXPECT_EQ(test::faultOf([&] { step(other, other, box.vertices, box.vertices, {}, state); }),
              Fault::indexOutOfRange);
    EXPECT_EQ(state, before);
}

/// Open, in pieces, with a spike of no area, doubled and unused vertices.
TEST(ActivePairs, TakeSurfacesAsTheyCome) {
    scenes::Mesh odd = scenes::merged(scenes::grid(1, 1, 6, 6), scenes::box({0.2F, 0.2F, 0.2F}, 2), {0, 0.5F, 0});
    const auto copy = static_cast<std::uint32_t>(odd.vertices.size());
    odd.vertices.push_back(odd.vertices[odd.triangles[0][0]]);
    odd.triangles[0][0] = copy;
    odd.triangles.push_back({1, 2, 2});
    odd.vertices.emplace_back(100, 100, 100);  // no triangle has it
    const Surface surface = buildSurface(odd.view());
    std::vector<Eigen::Vector3f> below = odd.vertices;
    for (Eigen::Vector3f& vertex : below) {
        vertex += Eigen::Vector3f(0.07F, 0.31F, 0.03F);
    }
    for (const bool multires : {false, true}) {
        Settings settings;
        settings.hierarchyShare = 0.5;
        settings.multires = multires;
        State state;
        std::size_t contacts = 0;
        for (int i = 0; i < 5; ++i) {
            contacts += step(surface, surface, odd.vertices, below, settings, state).contacts.size();
        }
        EXPECT_GT(contacts, 0U);
    }
}

}  // namespace
}  // namespace grapeshot::scf::reference
