#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "scene_rows.hpp"
#include "soft_run.hpp"
#include "soft_scenarios.hpp"
#include "support/sheet_oracle.hpp"
#include "support/soft_shot.hpp"

namespace grapeshot::bench {

namespace {

constexpr int cells = 14;  // of a sheet of 2 m

/// Rigid vertices behind the sheet in the end, of all.
double shareBehind(const SoftMethod& method, const scenes::Mesh& mesh, std::uint64_t seed, std::uint64_t shot,
                   std::vector<double>& timesUs) {
    const test::SoftShot drawn = test::softShot(seed, shot);
    SoftWorld world(method);
    world.setGravity(0);
    btSoftBody& sheet = world.addSoft(scenes::grid(1, 1, cells, cells), 5, 0.02);
    for (int i = 0; i < sheet.m_nodes.size(); ++i) {
        const btVector3& x = sheet.m_nodes[i].m_x;
        if (btMax(btFabs(x.x()), btFabs(x.z())) > btScalar(0.999)) {
            sheet.setMass(i, 0);
        }
    }
    const btRigidBody& body = world.throwMesh(mesh, 0.005, drawn.from, drawn.velocity);
    for (int i = 0; i < drawn.steps; ++i) {
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
