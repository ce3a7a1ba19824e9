// What each setting does, and which values are refused.
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <vector>

#include <support/fault_of.hpp>
#include "bodies.hpp"

namespace grapeshot::scf::reference {
namespace {

using test::approach;
using test::bodies;
using test::History;

TEST(Settings, EverySettingDoesSomething) {
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
    const History before = approach(bodies(), base);
    for (const Change& change : changes) {
        Settings settings = base;
        change.apply(settings);
        const History after = approach(bodies(), settings);
        EXPECT_TRUE(after.state != before.state || after.results != before.results) << change.name;
    }
}

TEST(Settings, ChangeLevelsWhereTheSettingsSay) {
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

TEST(Settings, TheSumOfRadiiFindsMoreThanThereIs) {
    Settings settings;
    settings.collisionTest = CollisionTest::radii;
    State state;
    EXPECT_FALSE(bodies().step(settings, state, 1.35F).contacts.empty());
    settings.collisionTest = CollisionTest::triangles;
    State exact;
    EXPECT_TRUE(bodies().step(settings, exact, 1.35F).contacts.empty());
    EXPECT_GT(exact.pairs.front().distance, 0.05F);
}

TEST(Settings, SettingsOutOfRangeAreNamed) {
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

}  // namespace
}  // namespace grapeshot::scf::reference
