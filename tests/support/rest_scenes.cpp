#include "rest_scenes.hpp"

#include <Eigen/Geometry>
#include <numbers>

namespace grapeshot::test {

using namespace scenes;

namespace {

PoseD at(double x, double y, double z, double angle = 0, const Eigen::Vector3d& axis = Eigen::Vector3d::UnitY()) {
    return {Eigen::AngleAxisd(angle, axis).toRotationMatrix(), {x, y, z}};
}

std::size_t add(World& world, const Mesh& fixed, const Mesh& moving, const PoseD& start) {
    world.addBody(world.addMesh(fixed), PoseD{}, 0);
    return world.addBody(world.addMesh(moving), start, 1);
}

/// Between the teeth of comb(5, 0.8, 0.8, 0.4), 10 cm narrower than the gaps on each side.
Mesh rails() {
    const Eigen::Vector3f rail{0.1F, 0.49F, 0.6F};
    Mesh mesh = box({2, 0.25F, 0.6F}, 3);
    for (int i = 0; i < 4; ++i) {
        mesh = merged(mesh, box(rail, 2), {0.8F * (static_cast<float>(i) - 1.5F), 0.76F, 0});
    }
    return mesh;
}

}  // namespace

std::string_view name(RestScene scene) noexcept {
    switch (scene) {
        case RestScene::uOnBar:
            return "u_on_bar";
        case RestScene::crossInHole:
            return "cross_in_hole";
        case RestScene::interlockedTori:
            return "interlocked_tori";
        case RestScene::combInRails:
            return "comb_in_rails";
        case RestScene::nutOnBolt:
            return "nut_on_bolt";
        case RestScene::torusOnTorus:
            return "torus_on_torus";
        case RestScene::ballInCup:
            return "ball_in_cup";
    }
    return "unknown";
}

std::size_t addRestScene(World& world, RestScene scene) {
    const double quarter = std::numbers::pi / 2;
    switch (scene) {
        case RestScene::uOnBar:
            return add(world, box({2.0F, 0.25F, 0.25F}, 4), uBody(1.6F, 1.0F, 0.3F, 0.6F, 3),
                       at(0, 1.2, 0.05, quarter + 0.1));
        case RestScene::crossInHole:
            return add(world,
                       merged(plateWithCrossHole(2.0F, 0.5F, 1.0F, 0.5F, 0.06F, 2), box({2.0F, 0.25F, 2.0F}, 4),
                              {0, -0.75F, 0}),
                       crossPlug(1.0F, 0.5F, 1.2F, 3), at(0.01, 1.2, -0.01, 0.01));
        case RestScene::interlockedTori:
            return add(world, torus(1.0F, 0.25F, 48, 24), torus(1.0F, 0.25F, 48, 24),
                       at(1.0, 0, 0.02, quarter, Eigen::Vector3d::UnitX()));
        case RestScene::combInRails:
            return add(world, rails(), comb(5, 0.8F, 0.8F, 0.4F, 2), at(0.01, 1.2, 0.02, 0.02));
        case RestScene::nutOnBolt: {
            // Bullet's default resists sliding along one direction alone, so a nut creeps down whatever its contacts.
            world.dynamics().getSolverInfo().m_solverMode |= SOLVER_USE_2_FRICTION_DIRECTIONS;
            const Thread thread{1, 0.16F, 1};
            return add(world, threadedRod(thread, 5, 36, 60), threadedNut(thread, 0.12F, 3.2F, 1.6F, 36, 20),
                       at(0, 0.01, 0));
        }
        case RestScene::torusOnTorus:
            return add(world, torus(1.0F, 0.25F, 48, 24), torus(0.8F, 0.25F, 48, 24), at(0.02, 0.6, 0.01, 0.05));
        case RestScene::ballInCup:
            return add(world, cup(1.0F, 0.15F, 1.2F, 48, 12), bumpySphere(0.5F, 0.12F, 5, 10, 19),
                       at(0.15, 0.9, 0.1, 0.4));
    }
    return 0;
}

WorldSettings undamped(Engine engine, double margin) {
    WorldSettings settings;
    settings.engine = engine;
    settings.margin = margin;
    settings.sleeping = false;
    settings.linearDamping = 0;
    settings.angularDamping = 0;
    settings.lower = Eigen::Vector3d::Constant(-10);
    settings.upper = Eigen::Vector3d::Constant(10);
    return settings;
}

}  // namespace grapeshot::test
