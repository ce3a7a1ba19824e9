#include "cannonball.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include <grapeshot/core/mesh_report.hpp>

namespace grapeshot::scenes {

using Eigen::Vector3d;
using Eigen::Vector3f;

namespace {

constexpr double margin = 0.01;          // m; meshes rest two of them apart
constexpr double stone = 1800;           // kg/m^3
constexpr double iron = 5000;            // kg/m^3, cast, with blowholes
constexpr double furtherBallMass = 600;  // kg

PoseD at(const Vector3d& position, double turn = 0) {
    return {Eigen::AngleAxisd(turn, Vector3d::UnitY()).toRotationMatrix(), position};
}

class Builder {
  public:
    explicit Builder(const CannonballSettings& settings)
        : m_settings(settings), m_scene{.world = World(worldSettings())} {}

    CannonballScene build() {
        buildGround();
        buildWall();
        buildTowers();
        loadCannons();
        if (m_settings.perturbation > 0) {
            for (const std::size_t ball : m_scene.balls) {
                m_scene.world.perturb(ball, m_settings.perturbation, m_settings.seed);
            }
        }
        for (std::size_t body = 0; body < m_scene.world.bodies(); ++body) {
            m_scene.triangles += m_scene.world.moving(body) ? m_scene.world.mesh(body).triangles.size() : 0;
        }
        return std::move(m_scene);
    }

  private:
    [[nodiscard]] WorldSettings worldSettings() const {
        WorldSettings world;
        world.engine = m_settings.engine;
        world.settings = m_settings.settings;
        world.timeStep = 1.0 / 120;
        world.margin = margin;
        world.friction = 0.75;
        world.linearDamping = 0.02;
        world.angularDamping = 0.05;
        world.lower = {-30, -1, -30};
        world.upper = {30, 30, 30};
        return world;
    }

    [[nodiscard]] int cut(double count) const {
        return std::max(1, static_cast<int>(std::lround(count * m_settings.detail)));
    }

    void buildGround() {
        World& world = m_scene.world;
        if (m_settings.meshGround) {
            m_scene.ground = world.addMeshFloor(grid(30, 30, cut(40), cut(40)));
        } else {
            m_scene.ground = world.addPlane(Vector3d::UnitY(), 0);
        }
    }

    struct Kind {
        std::size_t mesh;
        double mass;  ///< kg
    };

    Kind prepare(const Mesh& mesh, double density) {
        return {m_scene.world.addMesh(mesh), density * inspect(mesh.view()).volume};
    }

    void addBlock(const Kind& kind, const Vector3d& position, double turn = 0) {
        m_scene.blocks.push_back(m_scene.world.addBody(kind.mesh, at(position, turn), kind.mass));
    }

    /// A row of arches, long crenelled blocks across their joints, short ones on the teeth.
    void buildWall() {
        constexpr int arches = 4;
        const Vector3f archHalf(0.75F, 0.5F, 0.3F);
        const Vector3f longHalf(1.01F, 0.25F, 0.3F);
        const Vector3f shortHalf(0.75F, 0.25F, 0.3F);
        const Kind arch = prepare(archBlock(archHalf, 0.5F, 12, cut(1)), stone);
        const Kind longBlock = prepare(crenelBlock(longHalf, 5, cut(1)), stone);
        const Kind shortBlock = prepare(crenelBlock(shortHalf, 3, cut(1)), stone);
        constexpr double gap = 2 * margin;
        const auto row = [&](const Kind& kind, int count, double halfLength, double y) {
            for (int i = 0; i < count; ++i) {
                addBlock(kind, {(i - 0.5 * (count - 1)) * (2 * halfLength + gap), y, 0});
            }
        };
        row(arch, arches, archHalf.x(), 0.5 + margin);
        row(longBlock, arches - 1, longHalf.x(), 1.25 + margin + gap);
        row(shortBlock, arches, shortHalf.x(), 1.75 + margin + 2 * gap);
    }

    /// Pairs of blocks laid crosswise, the last pair crenelled.
    void buildTowers() {
        const Vector3f half(0.6F, 0.35F, 0.2F);
        const Kind arch = prepare(archBlock(half, 0.32F, 12, cut(1)), stone);
        const Kind crenel = prepare(crenelBlock(half, 3, cut(1)), stone);
        for (const auto& [foot, levels] : {std::pair{Vector3d(0.5, 0, 3.2), 5}, std::pair{Vector3d(-2.2, 0, 2.4), 4}}) {
            for (int level = 0; level < levels; ++level) {
                const double y = half.y() + margin + level * (2 * half.y() + 2 * margin);
                const bool crosswise = level % 2 != 0;
                for (const double side : {-0.4, 0.4}) {
                    const Vector3d offset = crosswise ? Vector3d(side, y, 0) : Vector3d(0, y, side);
                    addBlock(level == levels - 1 ? crenel : arch, foot + offset, crosswise ? std::numbers::pi / 2 : 0);
                }
            }
        }
    }

    void shoot(const std::string& name, const Mesh& mesh, double mass, const PoseD& pose, const Motion& motion) {
        m_scene.balls.push_back(m_scene.world.addBody(m_scene.world.addMesh(mesh), pose, mass, motion));
        m_scene.ballNames.push_back(name);
    }

    void loadCannons() {
        const Mesh spiked =
            spikedBall(0.28F, 0.16F, 18, static_cast<int>(1500 * m_settings.detail * m_settings.detail));
        const Mesh link = ring(0.34F, 0.075F, cut(28), cut(12));
        const Mesh hollow = cup(0.36F, 0.09F, 0.6F, cut(24), cut(6));
        const auto massOf = [](const Mesh& mesh) { return iron * inspect(mesh.view()).volume; };

        shoot("spiked ball", spiked, massOf(spiked), at({0.1, 1.2, -5}), {{0, 2.2, 19}, {3, 1, 2}});
        shoot("spiked ball, high", spiked, massOf(spiked), at({0.6, 2.1, -7.5}), {{0, 4.4, 21}, {-4, 2, 0}});

        // Two rings through each other, flying and tumbling together.
        const Vector3d chain(-1.6, 1.6, -6);
        const Motion together{{0.3, 2.6, 18}, {0, 4, 0}};
        shoot("chain shot, first ring", link, massOf(link), at(chain), together);
        PoseD standing;
        standing.rotation = Eigen::AngleAxisd(std::numbers::pi / 2, Vector3d::UnitX()).toRotationMatrix();
        standing.translation = chain + Vector3d(0.34, 0, 0);
        shoot("chain shot, second ring", link, massOf(link), standing, together);

        PoseD lying;
        lying.rotation = Eigen::AngleAxisd(1.3, Vector3d::UnitX()).toRotationMatrix();
        lying.translation = {1.7, 1.3, -6.5};
        shoot("cup", hollow, massOf(hollow), lying, {{-0.4, 2.8, 17}, {2, 0, 3}});

        for (std::size_t i = 0; i < m_settings.furtherBalls.size(); ++i) {
            const Mesh ball = normalised(m_settings.furtherBalls[i], static_cast<float>(m_settings.furtherBallSize));
            const double x = -0.9 + 0.9 * static_cast<double>(i % 3);
            const double z = -9 - 1.5 * static_cast<double>(i / 3);  // NOLINT(bugprone-integer-division): rows of three
            shoot("mesh " + std::to_string(i + 1), ball, furtherBallMass, at({x, 2.0, z}), {{0, 3.5, 18}, {1, 2, 1}});
        }
    }

    const CannonballSettings& m_settings;
    CannonballScene m_scene;
};

}  // namespace

CannonballScene makeCannonball(const CannonballSettings& settings) {
    return Builder(settings).build();
}

}  // namespace grapeshot::scenes
