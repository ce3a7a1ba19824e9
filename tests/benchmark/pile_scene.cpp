#include "pile_scene.hpp"

#include <algorithm>
#include <cmath>

#include <support/poses.hpp>

namespace grapeshot::bench {

using namespace scenes;

namespace {

constexpr double pitHalf = 3.3;  ///< m, inside
constexpr double layer = 2.1;    ///< m between bodies at the start: they are 2 m wide

/// Farthest vertex from the centre of mass at `pileRadius`.
Mesh toRadius(const Mesh& mesh) {
    const Eigen::Vector3d centre = bodyFrame(mesh).centre;
    double radius = 0;
    for (const Eigen::Vector3f& vertex : mesh.vertices) {
        radius = std::max(radius, (vertex.cast<double>() - centre).norm());
    }
    return scaled(moved(mesh, -centre.cast<float>()), static_cast<float>(pileRadius / radius));
}

std::vector<Mesh> kinds(int triangles) {
    const double fine = std::sqrt(triangles / 5000.0);
    const auto cells = [&](double atFiveThousand) {
        return std::max(2, static_cast<int>(std::lround(atFiveThousand * fine)));
    };
    return {toRadius(bumpySphere(1.0F, 0.25F, 7, cells(16), 77)),
            toRadius(torusKnot(2, 3, 1.0F, 0.4F, 0.22F, cells(180), cells(14))),
            toRadius(gear(1.0F, 0.16F, 0.3F, 0.5F, 15, cells(2.6))), toRadius(spikedBall(0.7F, 0.35F, 30, triangles)),
            toRadius(cup(0.8F, 0.12F, 1.3F, cells(46), cells(17)))};
}

}  // namespace

World makePile(WorldSettings method, const PileSettings& settings) {
    const double wallHeight = std::max(40.0, layer * (settings.bodies / 9 + 2));
    method.margin = settings.margin;
    method.lower = {-pitHalf - 1, 0, -pitHalf - 1};
    method.upper = {pitHalf + 1, wallHeight, pitHalf + 1};
    World world(method);

    const float outside = static_cast<float>(pitHalf) + 1;
    if (settings.floor == PileFloor::mesh) {
        world.addMeshFloor(grid(outside, outside, 8, 8));
    } else {
        world.addBox({outside, 0.5, outside}, {Eigen::Matrix3d::Identity(), {0, -0.5, 0}}, 0);
    }
    const auto wall = [&](const Eigen::Vector3d& half, const Eigen::Vector3d& centre) {
        world.addBox(half, {Eigen::Matrix3d::Identity(), centre}, 0);
    };
    const double y = wallHeight / 2 - 1;
    for (const double side : {-1.0, 1.0}) {
        wall({0.5, wallHeight / 2, pitHalf + 1}, {side * (pitHalf + 0.5), y, 0});
        wall({pitHalf + 1, wallHeight / 2, 0.5}, {0, y, side * (pitHalf + 0.5)});
    }

    std::vector<std::size_t> meshes;
    for (const Mesh& mesh : kinds(settings.trianglesPerBody)) {
        meshes.push_back(world.addMesh(mesh));
    }
    test::Random random(settings.seed);
    for (int i = 0; i < settings.bodies; ++i) {
        const int place = i % 9;
        const int row = place / 3;
        const int floor = i / 9;
        const Eigen::Vector3d centre{layer * (place % 3 - 1) + random.uniform(-0.05, 0.05), 1.3 + layer * floor,
                                     layer * (row - 1) + random.uniform(-0.05, 0.05)};
        const std::size_t mesh = meshes[static_cast<std::size_t>(i) % meshes.size()];
        world.addBody(mesh, {random.rotation().cast<double>(), centre}, 1);
    }
    return world;
}

}  // namespace grapeshot::bench
