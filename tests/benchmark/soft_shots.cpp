#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include <grapeshot/core/random.hpp>

#include "scene_rows.hpp"
#include "soft_run.hpp"
#include "soft_scenarios.hpp"
#include "support/sheet_oracle.hpp"

namespace grapeshot::bench {

namespace {

constexpr int cells = 14;  // of a sheet of 2 m

/// Rigid vertices behind the sheet in the end, of all; 1 to 30 m/s from half a metre and more away, turned anyhow.
double shareBehind(const SoftMethod& method, const scenes::Mesh& mesh, std::uint64_t seed, std::uint64_t shot,
                   std::vector<double>& timesUs) {
    std::uint32_t drawn = 0;
    const auto draw = [&](double from, double to) {
        return btScalar(from + (to - from) * static_cast<double>(randomUnit({seed, shot, 0}, drawn++)));
    };
    SoftWorld world(method);
    world.setGravity(0);
    btSoftBody& sheet = world.addSoft(scenes::grid(1, 1, cells, cells), 5, 0.02);
    for (int i = 0; i < sheet.m_nodes.size(); ++i) {
        const btVector3& x = sheet.m_nodes[i].m_x;
        if (btMax(btFabs(x.x()), btFabs(x.z())) > btScalar(0.999)) {
            sheet.setMass(i, 0);
        }
    }
    const btScalar speed = draw(1, 30);
    const btScalar x = draw(-0.5, 0.5);
    const btScalar y = draw(0.5, 1.5);
    const btScalar z = draw(-0.5, 0.5);
    const btScalar turnX = draw(-1, 1);
    const btScalar turnY = draw(-1, 1);
    const btTransform pose(btQuaternion(turnX, turnY, draw(-1, 1), btScalar(1.5)).normalized(), {x, y, z});
    const btScalar aslant = draw(-0.1, 0.1);
    const btRigidBody& body = world.throwMesh(mesh, 0.005, pose, speed * btVector3(aslant, -1, draw(-0.1, 0.1)));
    const int steps = static_cast<int>(150 / static_cast<double>(speed)) + 60;
    for (int i = 0; i < steps; ++i) {
        timesUs.push_back(world.step().wholeUs);
    }
    std::vector<Eigen::Vector3d> vertices;
    for (const Eigen::Vector3f& v : mesh.vertices) {
        const btVector3 place = body.getWorldTransform() * btVector3(v.x(), v.y(), v.z());
        vertices.emplace_back(place.x(), place.y(), place.z());
    }
    const std::vector<Eigen::Vector3d> nodes = world.positions(0);
    return test::pointsBelow({nodes, world.mesh(0).triangles}, vertices) / static_cast<double>(vertices.size());
}

}  // namespace

void runSoftShots(const Options& options, report::Report& results) {
    const std::array meshes{std::pair("box", scenes::box({0.15F, 0.15F, 0.15F}, 2)),
                            std::pair("plate", scenes::box({0.01F, 0.2F, 0.2F}, 2)),
                            std::pair("spiked ball", scenes::spikedBall(0.12F, 0.1F, 12, 800)),
                            std::pair("torus", scenes::torus(0.15F, 0.05F, 24, 12))};
    for (const auto& [name, mesh] : meshes) {
        for (const SoftMethod& method : softMethods()) {
            const int shots = options.quick ? 10 : 500;
            report::Row row;
            std::vector<double> timesUs;
            int through = 0;
            int inPart = 0;
            for (int shot = 0; shot < shots; ++shot) {
                const double behind =
                    shareBehind(method, mesh, options.seed, static_cast<std::uint64_t>(shot), timesUs);
                through += behind > 0.5 ? 1 : 0;
                inPart += behind > 0 && behind <= 0.5 ? 1 : 0;
            }
            row.scenario = "shots at a sheet, step";
            row.mesh = name;
            row.triangles = mesh.triangles.size();
            row.method = method.name;
            row.n = static_cast<std::size_t>(shots);
            row.timeUs = report::quantiles(timesUs);
            row.measured = {{"through", through}, {"inPart", inPart}};
            results.rows.push_back(std::move(row));
            if (method.name != bulletsOwn) {
                Claims claims(std::string("soft shots ") + name, results);
                claims.atMost("through the sheet", through, 0);
            }
        }
    }
}

}  // namespace grapeshot::bench
