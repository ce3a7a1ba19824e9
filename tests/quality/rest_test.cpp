// Non-convex bodies come to rest on, in and around each other, and stay; GImpact in the same scenes.
#include <gtest/gtest.h>

#include <string>
#include <tuple>

#include <support/rest_scenes.hpp>

#include "lab.hpp"

namespace grapeshot::test {
namespace {

struct Rest {
    double residual = 0;  ///< RMS speed over the second half, m/s
    double drift = 0;     ///< way of the body during the second half, m
    double depth = 0;     ///< deepest true penetration at any whole second, m
    int lost = 0;
    double contacts = 0;  ///< mean of the second half
};

/// Sleeping and damping off: only the contacts can bring the body to rest.
Rest settle(RestScene scene, scenes::Engine engine, const Settings& given = {}, double seconds = 12) {
    scenes::WorldSettings undampedSettings = undamped(engine, 0.02);
    undampedSettings.settings = given;
    scenes::World world(undampedSettings);
    const std::size_t body = addRestScene(world, scene);
    const int steps = static_cast<int>(std::lround(seconds / world.settings().timeStep));
    Rest rest;
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (int step = 1; step <= steps; ++step) {
        const scenes::StepRecord record = world.step();
        if (2 * step == steps) {
            middle = position(world.body(body));
        }
        if (2 * step > steps) {
            rest.residual += record.rmsSpeed * record.rmsSpeed;
            rest.contacts += record.contacts;
        }
        if (step % 60 == 0) {
            rest.depth = std::max(rest.depth, world.deepestPenetration(world.poses()));
        }
        rest.lost = record.lost;
    }
    rest.residual = std::sqrt(2 * rest.residual / steps);
    rest.contacts *= 2.0 / steps;
    rest.drift = (position(world.body(body)) - middle).norm();
    return rest;
}

/// Scf with so little for its searches that it samples, too.
class ComesToRest : public testing::TestWithParam<std::tuple<RestScene, Way>> {};

TEST_P(ComesToRest, AndStays) {
    const auto& [scene, way] = GetParam();
    const Rest rest = settle(scene, scenes::Engine::grapeshot, way.settings());
    EXPECT_EQ(rest.lost, 0);
    EXPECT_LT(rest.residual, 0.02);
    EXPECT_LT(rest.drift, 0.02);
    EXPECT_LT(rest.depth, 0.02);
    EXPECT_GE(rest.contacts, 1);
}

#ifdef BT_USE_DOUBLE_PRECISION
constexpr std::size_t waysHere = 1;  // the searches are the same in both precisions
#else
constexpr std::size_t waysHere = std::size(ways);
#endif

INSTANTIATE_TEST_SUITE_P(Scenes, ComesToRest,
                         testing::Combine(testing::ValuesIn(allRestScenes),
                                          testing::ValuesIn(std::begin(ways), std::begin(ways) + waysHere)),
                         [](const auto& sample) {
                             return std::string(name(std::get<0>(sample.param))) + "_" + std::get<1>(sample.param).name;
                         });

class AgainstGimpact : public testing::TestWithParam<RestScene> {};

TEST_P(AgainstGimpact, ComesToRestNoWorse) {
    const Rest ours = settle(GetParam(), scenes::Engine::grapeshot);
    const Rest gimpact = settle(GetParam(), scenes::Engine::gimpact);
    EXPECT_LE(ours.lost, gimpact.lost);
    EXPECT_LE(ours.residual, gimpact.residual);
    EXPECT_LE(ours.depth, gimpact.depth + 0.002);
}

INSTANTIATE_TEST_SUITE_P(Scenes, AgainstGimpact, testing::ValuesIn(allRestScenes),
                         [](const auto& sample) { return std::string(name(sample.param)); });

}  // namespace
}  // namespace grapeshot::test
