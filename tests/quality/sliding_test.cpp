// A block of triangles slides to rest, and a ball of triangles bounces: against Bullet's own and against the formula.
#include <gtest/gtest.h>

#include "lab.hpp"

namespace grapeshot::test {
namespace {

std::string floorName(const testing::TestParamInfo<Floor>& sample) {
    return sample.param == Floor::plane ? "plane" : (sample.param == Floor::mesh ? "mesh" : "box");
}

struct Slid {
    double distance = 0;  ///< m
    double endSpeed = 0;  ///< m/s
    double sideways = 0;  ///< m
};

Slid slide(Body kind, Floor floor, double startSpeed, double friction, const Settings& given = {}) {
    scenes::WorldSettings settings = labSettings();
    settings.settings = given;
    // Bullet multiplies the two frictions.
    settings.friction = std::sqrt(friction);
    scenes::World world(settings);
    addFloor(world, floor);
    const Eigen::Vector3d half{0.4, 0.15, 0.3};
    const Eigen::Vector3d start{-3, half.y() + restGap(kind, floor), 0};
    const scenes::Motion motion{.velocity = {startSpeed, 0, 0}};
    const std::size_t body =
        kind == Body::mesh ? world.addBody(world.addMesh(scenes::box(half.cast<float>(), 4)), at(start), 1, motion)
                           : world.addBox(half, at(start), 1, motion);
    const double seconds = 1.5 * startSpeed / (friction * gravity);
    for (int step = 0; step < static_cast<int>(std::lround(seconds / settings.timeStep)); ++step) {
        world.step();
    }
    const Eigen::Vector3d way = position(world.body(body)) - start;
    return {way.x(), velocity(world.body(body)).norm(), std::abs(way.z())};
}

/// Bullet's own is taken on Bullet's own plane: its box trips over the inner edges of a mesh floor (and stops 19 %
/// short).
class Sliding : public testing::TestWithParam<Floor> {};

TEST_P(Sliding, TheWayToRestIsThatOfTheFormula) {
    const double startSpeed = 4;
    const double friction = 0.3;
    const double expected = startSpeed * startSpeed / (2 * friction * gravity);
    const Slid mesh = slide(Body::mesh, GetParam(), startSpeed, friction);
    const Slid primitive = slide(Body::primitive, Floor::plane, startSpeed, friction);
    EXPECT_NEAR(mesh.distance, expected, 0.02 * expected);
    EXPECT_NEAR(mesh.distance, primitive.distance, 0.02 * primitive.distance);
    EXPECT_LT(mesh.endSpeed, 0.01);
    EXPECT_LT(mesh.sideways, 0.02);
}

INSTANTIATE_TEST_SUITE_P(Floors, Sliding, testing::Values(Floor::plane, Floor::mesh, Floor::box), floorName);

class SlidingByMethod : public testing::TestWithParam<Way> {};

TEST_P(SlidingByMethod, TheWayToRestOnAMeshIsThatOfTheFormula) {
    const Slid slid = slide(Body::mesh, Floor::mesh, 2, 0.3, GetParam().settings());
    const double expected = 2 * 2 / (2 * 0.3 * gravity);
    EXPECT_NEAR(slid.distance, expected, 0.02 * expected);
    EXPECT_LT(slid.endSpeed, 0.01);
    EXPECT_LT(slid.sideways, 0.02);
}

INSTANTIATE_TEST_SUITE_P(Ways, SlidingByMethod, testing::ValuesIn(ways),
                         [](const auto& sample) { return std::string(sample.param.name); });

struct Bounce {
    double height = 0;  ///< m above rest, from which it falls
    double top = 0;     ///< m above rest, after the first bounce
};

/// A small ball and short steps: Bullet makes a contact as soon as bodies are closer than 2 % of their size, and one
/// that is made before the ball arrives takes its speed without giving any back. So a step must be longer than that,
/// and the height is such that the ball arrives at the end of a step, a hundredth of a step's way deep (what is deeper
/// is pushed out by its own speed on top).
Bounce bounce(Body kind, Floor floor, double restitution) {
    constexpr double radius = 0.05;
    constexpr int fallingSteps = 450;
    scenes::WorldSettings settings = labSettings();
    settings.margin = 0.01 * radius;
    settings.timeStep = 1.0 / 1000;
    // Bullet multiplies the two restitutions.
    settings.restitution = std::sqrt(restitution);
    scenes::World world(settings);
    addFloor(world, floor);
    const double dt = settings.timeStep;
    const double way = gravity * dt * dt * fallingSteps * (fallingSteps + 1) / 2;
    Bounce result;
    result.height = way - 0.01 * gravity * fallingSteps * dt * dt;
    const double rest = radius + restGap(kind, floor, settings.margin);
    const Eigen::Vector3d start{0.03, rest + result.height, 0.05};
    std::unique_ptr<PrimitiveSphere> primitive;
    btRigidBody* body = nullptr;
    if (kind == Body::mesh) {
        const auto size = static_cast<float>(radius);
        body = &world.body(world.addBody(world.addMesh(scenes::sphere(size, 24)), at(start, 0.3), 1));
    } else {
        primitive = std::make_unique<PrimitiveSphere>(world, radius, start);
        body = &primitive->body();
    }
    bool rising = false;
    for (int step = 0; step < 3 * fallingSteps; ++step) {
        world.step();
        const double speed = velocity(*body).y();
        rising = rising || speed > 0;
        if (rising) {
            result.top = std::max(result.top, position(*body).y() - rest);
        }
        if (rising && speed < 0) {
            break;
        }
    }
    return result;
}

class Bouncing : public testing::TestWithParam<Floor> {};

TEST_P(Bouncing, TheHeightIsThatOfTheFormula) {
    const double restitution = 0.7;
    const Bounce mesh = bounce(Body::mesh, GetParam(), restitution);
    const Bounce primitive = bounce(Body::primitive, Floor::plane, restitution);
    const double expected = restitution * restitution * mesh.height;
    EXPECT_NEAR(mesh.top, expected, 0.02 * expected);
    EXPECT_NEAR(mesh.top, primitive.top, 0.02 * primitive.top);
}

INSTANTIATE_TEST_SUITE_P(Floors, Bouncing, testing::Values(Floor::plane, Floor::mesh, Floor::box), floorName);

}  // namespace
}  // namespace grapeshot::test
