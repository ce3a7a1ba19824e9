#include "named_scenes.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <numbers>

namespace grapeshot::scenes {
namespace {

using Eigen::Vector3d;

PoseD at(const Vector3d& position, double turn = 0, const Vector3d& axis = Vector3d::UnitY()) {
    return {Eigen::AngleAxisd(turn, axis.normalized()).toRotationMatrix(), position};
}

void pile(World& world) {
    world.addMeshFloor(grid(4, 4, 12, 12));
    const std::array meshes{world.addMesh(torus(0.4F, 0.15F, 32, 16)), world.addMesh(cup(0.35F, 0.06F, 0.6F, 24, 8)),
                            world.addMesh(bumpySphere(0.4F, 0.08F, 5, 10))};
    for (int i = 0; i < 12; ++i) {
        const Vector3d where(0.3 * (i % 3) - 0.3, 0.6 + 0.5 * i, 0.25 * (i % 4) - 0.4);
        world.addBody(meshes[static_cast<std::size_t>(i) % meshes.size()], at(where, i, {1, 0.3, 0.1}), 1);
    }
}

void tori(World& world) {
    world.addMeshFloor(grid(4, 4, 12, 12));
    const std::size_t ring = world.addMesh(torus(0.5F, 0.12F, 40, 20));
    world.addBody(ring, at({0, 0.8, 0}), 1);
    world.addBody(ring, at({0.5, 0.8, 0}, std::numbers::pi / 2, Vector3d::UnitX()), 1);
}

void uOnBar(World& world) {
    world.addBody(world.addMesh(box({0.1F, 0.1F, 1}, 4)), at({0, 1, 0}), 0);
    world.addBody(world.addMesh(uBody(0.8F, 0.5F, 0.15F, 0.3F, 3)), at({0, 1.3, 0}), 1);
}

void cross(World& world) {
    world.addBody(world.addMesh(plateWithCrossHole(1, 0.3F, 0.4F, 0.16F, 0.02F, 3)), at({0, 0, 0}), 0);
    world.addBody(world.addMesh(crossPlug(0.4F, 0.16F, 0.6F, 3)), at({0, 0.5, 0}), 1);
}

void chain(World& world) {
    const std::size_t link = world.addMesh(torus(0.3F, 0.06F, 32, 12));
    for (int i = 0; i < 6; ++i) {
        const double turn = i % 2 == 0 ? 0 : std::numbers::pi / 2;
        const Eigen::Matrix3d upright =
            (Eigen::AngleAxisd(turn, Vector3d::UnitY()) * Eigen::AngleAxisd(std::numbers::pi / 2, Vector3d::UnitX()))
                .toRotationMatrix();
        world.addBody(link, {upright, {0, 3 - 0.45 * i, 0}}, i == 0 ? 0 : 1);
    }
}

constexpr std::array scenes{
    NamedScene{"pile", "tori, cups and bumpy balls fall on a mesh floor", pile},
    NamedScene{"tori", "two linked tori fall on a mesh floor", tori},
    NamedScene{"u-on-bar", "a U drops on a bar and hangs there", uOnBar},
    NamedScene{"cross", "a cross-shaped plug drops into a hole of its shape", cross},
    NamedScene{"chain", "six links hang from the first", chain},
};

}  // namespace

std::span<const NamedScene> namedScenes() {
    return scenes;
}

const NamedScene* findScene(std::string_view name) {
    const auto* const found =
        std::find_if(scenes.begin(), scenes.end(), [&](const NamedScene& scene) { return scene.name == name; });
    return found != scenes.end() ? found : nullptr;
}

}  // namespace grapeshot::scenes
