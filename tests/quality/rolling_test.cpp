// A sphere of triangles against Bullet's own sphere and against the formula.
#include <gtest/gtest.h>

#include "lab.hpp"

namespace grapeshot::test {
namespace {

constexpr double radius = 0.5;  ///< m
/// 81 920 triangles: the edges are 2 cm. Coarser balls roll like the polyhedra they are: each facet that comes down
/// costs (5/14) (angle of a facet)^2 of the speed, 18 % a turn with edges of 4 cm.
const scenes::Mesh& ball() {
    static const scenes::Mesh mesh = scenes::sphere(static_cast<float>(radius), 64);
    return mesh;
}

/// Part of a force along the floor, or of a starting speed, that becomes speed of a rolling ball. 5/7 but for the
/// margins, on which the ball rolls.
double rollingShare(Floor floor) {
    const double lever = radius + restGap(Body::mesh, floor);
    return 1 / (1 + 0.4 * radius * radius / (lever * lever));
}

struct Rolled {
    double speed = 0;     ///< at the end, along x, m/s
    double slip = 0;      ///< of the contact point at the end, m/s
    double sideways = 0;  ///< m
};

Rolled roll(Body kind, Floor floor, double slope, double startSpeed, double seconds) {
    scenes::WorldSettings settings = labSettings();
    // Leaning gravity instead of a leaning floor: the same experiment.
    settings.gravity = {gravity * std::sin(slope), -gravity * std::cos(slope), 0};
    scenes::World world(settings);
    addFloor(world, floor);
    const double lever = radius + restGap(kind, floor);
    const Eigen::Vector3d start{-6, lever, 0};
    std::unique_ptr<PrimitiveSphere> primitive;
    btRigidBody* body = nullptr;
    if (kind == Body::mesh) {
        body = &world.body(world.addBody(world.addMesh(ball()), at(start, 0.3), 1));
    } else {
        primitive = std::make_unique<PrimitiveSphere>(world, radius, start);
        body = &primitive->body();
    }
    body->setLinearVelocity({static_cast<btScalar>(startSpeed), 0, 0});
    for (int step = 0; step < static_cast<int>(std::lround(seconds / settings.timeStep)); ++step) {
        world.step();
    }
    const double speed = velocity(*body).x();
    return {speed, speed + static_cast<double>(body->getAngularVelocity().z()) * lever, std::abs(position(*body).z())};
}

class Rolling : public testing::TestWithParam<Floor> {};

TEST_P(Rolling, DownASlopeSpeedGrowsAsTheFormulaSays) {
    const double slope = 0.3;
    const double seconds = 1.5;
    const double expected = rollingShare(GetParam()) * gravity * std::sin(slope) * seconds;
    const Rolled mesh = roll(Body::mesh, GetParam(), slope, 0, seconds);
    const Rolled primitive = roll(Body::primitive, Floor::plane, slope, 0, seconds);
    EXPECT_NEAR(mesh.speed, expected, 0.02 * expected);
    EXPECT_NEAR(mesh.speed, primitive.speed, 0.02 * primitive.speed);
    EXPECT_LT(std::abs(mesh.slip), 0.02 * mesh.speed);
    EXPECT_LT(mesh.sideways, 0.02);
}

TEST_P(Rolling, AfterSlidingFiveSeventhsOfTheSpeedAreLeft) {
    const double startSpeed = 4;
    const double expected = rollingShare(GetParam()) * startSpeed;
    const Rolled mesh = roll(Body::mesh, GetParam(), 0, startSpeed, 1.0);
    const Rolled primitive = roll(Body::primitive, Floor::plane, 0, startSpeed, 1.0);
    EXPECT_NEAR(mesh.speed, expected, 0.02 * expected);
    EXPECT_NEAR(mesh.speed, primitive.speed, 0.02 * primitive.speed);
    EXPECT_LT(std::abs(mesh.slip), 0.02 * mesh.speed);
}

INSTANTIATE_TEST_SUITE_P(Floors, Rolling, testing::Values(Floor::plane, Floor::mesh, Floor::box),
                         [](const auto& sample) -> std::string {
                             return sample.param == Floor::plane ? "plane"
                                                                 : (sample.param == Floor::mesh ? "mesh" : "box");
                         });

}  // namespace
}  // namespace grapeshot::test
