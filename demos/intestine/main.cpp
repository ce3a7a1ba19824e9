// `intestine`: a long tube on its mesentery falls on itself, and a hook pushes, lifts and lets go of it.
#include <Eigen/Geometry>
#include <algorithm>
#include <memory>

#include <soft/demo.hpp>

#include "instrument.hpp"
#include "organ.hpp"
#include "strands.hpp"

namespace grapeshot::intestine {
namespace {

constexpr double floorHalf = 5;       // m
constexpr double coverRadius = 0.05;  // m

scenes::Mesh cavity(int cells) {
    scenes::Mesh mesh = scenes::grid(floorHalf, floorHalf, cells, cells);
    for (Eigen::Vector3f& vertex : mesh.vertices) {
        vertex.y() = static_cast<float>(groundAt(static_cast<double>(vertex.x()), static_cast<double>(vertex.z())));
    }
    return mesh;
}

/// Beside a strand as it lies now, where no sheet is.
Operation operationOn(const StrandWatch& strands, int ring) {
    const Eigen::Vector3d at = strands.middleOf(ring);
    Eigen::Vector3d along = strands.middleOf(ring + 3) - strands.middleOf(ring - 3);
    along.y() = 0;
    Operation operation;
    operation.aside = along.normalized().cross(Eigen::Vector3d::UnitY());
    operation.spot = at - (tubeRadius + 0.12) * operation.aside;
    operation.spot.y() = std::max(at.y() - tubeRadius, groundAt(operation.spot.x(), operation.spot.z()) + 0.08);
    return operation;
}

struct IntestineOptions {
    OrganSettings organ;
    std::uint64_t budget = 0;
    int compareEvery = 60;
};

soft::Scene makeScene(soft::Method method, const IntestineOptions& settings, const soft::DemoOptions& options) {
    soft::Scene scene;
    scene.name = "intestine";
    scene.world =
        std::make_unique<soft::World>(method, options.seed, settings.budget > 0 ? settings.budget : unlimited);
    scene.camera = {.eye = {-2.0, 6.5, -3.0}, .target = {1.3, 0.2, 1.5}, .fieldOfView = 42};
    soft::World& world = *scene.world;
    world.addScenery(cavity(40), {0.80F, 0.72F, 0.66F});
    Organ organ = makeOrgan(world.info(), settings.organ);
    soft::CarriedSettings carrying;
    carrying.thickness = thickness;
    carrying.ground = groundAt;
    auto carried =
        std::make_unique<soft::CarriedBody>(world.info(), std::move(organ.core), std::move(organ.surface), carrying);
    const btSoftBody& body = carried->core();
    SelfCollision itself;
    itself.thickness = static_cast<float>(thickness);
    itself.exclusion = 0.1F;
    itself.spacing = 0.02F;
    world.add(std::move(carried), itself, {0.86F, 0.52F, 0.50F});
    world.compareEvery(settings.compareEvery, coverRadius);
    const int ring = organ.strand;
    const auto strands = std::make_shared<StrandWatch>(body, organ.rings, organ.around);
    const auto operation = std::make_shared<Operation>(operationOn(*strands, ring));
    const std::size_t tool = world.add(hook(12), instrumentPose(0, *operation), true, {0.55F, 0.60F, 0.68F});
    scene.beforeStep = [&world, tool, strands, operation, ring, chosen = false,
                        steps = options.steps](int step) mutable {
        const double progress = static_cast<double>(step + 1) / steps;
        if (!chosen) {
            *operation = operationOn(*strands, ring);
            chosen = progress > begin;
        }
        world.drive(tool, instrumentPose(progress, *operation));
    };
    scene.wrong = [strands] { return strands->passed(); };
    scene.apart = 2 * tubeRadius;
    scene.wrongName = "strands that passed through each other";
    return scene;
}

}  // namespace
}  // namespace grapeshot::intestine

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): what CLI11 says of wrong declarations
    using namespace grapeshot;
    intestine::IntestineOptions settings;
    soft::DemoOptions options;
    CLI::App app(
        "A long tube on its mesentery falls on itself; a hook pushes, lifts and lets go of it. Ten times as large as\n"
        "life. Prints times per frame of 1/30 s. Exit code: 0, 1 (something passed through or was lost), 2 (bad use).",
        "intestine");
    soft::addOptions(app, options);
    app.add_option("--length", settings.organ.length, "of the tube, m")
        ->check(CLI::Range(4.0, 50.0))
        ->capture_default_str();
    app.add_option(
           "--fineness", settings.organ.fineness,
           "pieces of the surface along each edge of what carries it: 1 is some 10,000 triangles, 3 some 90,000")
        ->check(CLI::Range(1, 16))
        ->capture_default_str();
    app.add_option("--budget", settings.budget,
                   "units that the search may have per pair and step; 0: all that it wants")
        ->capture_default_str();
    app.add_option("--compare", settings.compareEvery, "with a search to the end in every such step; 0: never")
        ->check(CLI::Range(0, 100000))
        ->capture_default_str();
    return soft::runMain(app, argc, argv, [&] {
        return soft::demo("intestine", options,
                          {[&](soft::Method method) { return intestine::makeScene(method, settings, options); }});
    });
}
