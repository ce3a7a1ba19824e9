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

using test::Bodies;

const Bodies& bodies() {
    static const Bodies both;
    return both;
}

/// From apart to 0.3 m deep.
constexpr int approachSteps = 12;
float distanceAt(int step) {
    return 1.4F - 0.04F * static_cast<float>(step);
}

struct History {
    State state;
    std::vector<StepResult> results;
};

History approach(const Settings& settings) {
    History history;
    for (int i = 0; i < approachSteps; ++i) {
        history.results.push_back(bodies().step(settings, history.state, distanceAt(i)));
    }
    return history;
}

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
        const History first = approach(settings);
        const History again = approach(settings);
        EXPECT_EQ(first.state, again.state);
        EXPECT_EQ(first.results, again.results);
        settings.seed = 2;
        EXPECT_NE(approach(settings).state, first.state);
        settings.seed = 1;
        settings.pair = 2;
        EXPECT_NE(approach(settings).state, first.state);
    }
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
    const State wide = approach({}).state;
    for (const InstructionSet set : {InstructionSet::scalar, InstructionSet::avx2}) {
        limitInstructionSet(set);
        EXPECT_EQ(approach({}).state, wide);
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
    // Nearly every triangle of A in contact is in the patch.
    std::set<std::uint32_t> touching;
    std::set<std::uint32_t> reached;
    for (const auto& [a, b] : truePairs(1.0F, 0.005)) {
        touching.insert(a);
    }
    for (const auto& [a, b] : patch) {
        reached.insert(a);
    }
    EXPECT_GT(reached.size(), touching.size() * 2 / 3);
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

TEST(ActivePairs, EverySettingDoesSomething) {
    struct Change {
        const char* name;
        std::function<void(Settings&)> apply;
    };
    const std::vector<Change> changes{
        {"newPairs", [](Settings& s) { s.newPairs = 20; }},
        {"velocityShare", [](Settings& s) { s.velocityShare = 0.5; }},
        {"hierarchyShare", [](Settings& s) { s.hierarchyShare = 0; }},
        {"hierarchyDepth", [](Settings& s) { s.hierarchyDepth = 2; }},
        {"tries", [](Settings& s) { s.tries = 8; }},
        {"multires", [](Settings& s) { s.multires = true; }},
        {"update", [](Settings& s) { s.update = Update::full; }},
        {"mostMoves", [](Settings& s) { s.mostMoves = 1; }},
        {"redundancy none", [](Settings& s) { s.redundancy = Redundancy::none; }},
        {"redundancy neighbours", [](Settings& s) { s.redundancy = Redundancy::neighbours; }},
        {"removeFar", [](Settings& s) { s.removeFar = false; }},
        {"removeFactor", [](Settings& s) { s.removeFactor = 3; }},
        {"removeOffset", [](Settings& s) { s.removeOffset = 0.05; }},
        {"collisionTest", [](Settings& s) { s.collisionTest = CollisionTest::radii; }},
        {"maxDistance", [](Settings& s) { s.maxDistance = 0.01F; }},
        {"spread", [](Settings& s) { s.spread = true; }},
        {"mostPairs", [](Settings& s) { s.mostPairs = 3; }},
    };
    Settings base;
    base.hierarchyShare = 0.5;
    base.removeFactor = 2;
    const History before = approach(base);
    for (const Change& change : changes) {
        Settings settings = base;
        change.apply(settings);
        const History after = approach(settings);
        EXPECT_TRUE(after.state != before.state || after.results != before.results) << change.name;
    }
}

TEST(ActivePairs, ChangeLevelsWhereTheSettingsSay) {
    Settings base = withoutHierarchy();
    base.multires = true;
    base.removeFar = false;
    const auto there = [](const Settings& settings) {
        std::vector<State> states;
        State state;
        for (const float distance : {1.2F, 3.0F, 4.0F, 5.0F, 6.0F, 5.0F, 4.0F, 3.0F, 2.0F, 1.2F}) {
            bodies().step(settings, state, distance);
            states.push_back(state);
        }
        return states;
    };
    Settings later = base;
    later.refineAt = 0.3;
    EXPECT_NE(there(later), there(base));
    Settings sooner = base;
    sooner.coarsenAt = 1.2;
    EXPECT_NE(there(sooner), there(base));
}

TEST(ActivePairs, TheSumOfRadiiFindsMoreThanThereIs) {
    Settings settings;
    settings.collisionTest = CollisionTest::radii;
    State state;
    EXPECT_FALSE(bodies().step(settings, state, 1.35F).contacts.empty());
    EXPECT_TRUE(truePairs(1.35F, 0.001).empty());
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

TEST(ActivePairs, SettingsOutOfRangeAreNamed) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const std::vector<std::function<void(Settings&)>> changes{
        [](Settings& s) { s.newPairs = -1; },
        [](Settings& s) { s.velocityShare = -0.1; },
        [](Settings& s) { s.hierarchyShare = 1.1; },
        [nan](Settings& s) { s.hierarchyShare = nan; },
        [](Settings& s) { s.velocityShare = 0.1; },  // 1.1 with the hierarchy's share
        [](Settings& s) { s.hierarchyDepth = -1; },
        [](Settings& s) { s.hierarchyDepth = 17; },
        [](Settings& s) { s.tries = 0; },
        [](Settings& s) { s.refineAt = 0; },
        [](Settings& s) { s.coarsenAt = 1; },
        [](Settings& s) { s.mostMoves = 0; },
        [](Settings& s) { s.removeFactor = 0.9; },
        [nan](Settings& s) { s.removeOffset = nan; },
        [](Settings& s) { s.maxDistance = -1; },
        [](Settings& s) { s.mostSpread = -1; },
        [](Settings& s) { s.mostPairs = 0; },
    };
    for (std::size_t i = 0; i < changes.size(); ++i) {
        Settings settings;
        changes[i](settings);
        State state;
        EXPECT_EQ(test::faultOf([&] { bodies().step(settings, state, 1.1F); }), Fault::badSetting) << i;
    }
    EXPECT_EQ(test::faultOf([] { requireUsable(withHierarchy()); }), std::nullopt);
    EXPECT_EQ(test::faultOf([] { requireUsable(withoutHierarchy()); }), std::nullopt);
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
