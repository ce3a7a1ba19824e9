// The procedure is that of:
// Gabriel Zachmann. Minimal Hierarchical Collision Detection. VRST 2002, section 6 (two copies, each within a cube of
// side 2, a full turn at each distance)
#include "paper_models.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include <grapeshot/core/mesh_report.hpp>
#include <support/poses.hpp>

namespace grapeshot::bench {

namespace {

/// Many closed pieces that run into each other, as pipes of a plant do.
scenes::Mesh rings(int count, int around) {
    test::Random random(9814);
    scenes::Mesh all;
    for (int i = 0; i < count; ++i) {
        scenes::Mesh ring = scenes::torus(0.45F, 0.05F, around, 8);
        const Eigen::Matrix3f turn = random.rotation();
        for (Eigen::Vector3f& vertex : ring.vertices) {
            vertex = turn * vertex;
        }
        const Eigen::Vector3f place(static_cast<float>(random.uniform(-0.6, 0.6)),
                                    static_cast<float>(random.uniform(-0.6, 0.6)),
                                    static_cast<float>(random.uniform(-0.6, 0.6)));
        all = scenes::merged(all, ring, place);
    }
    return all;
}

}  // namespace

PaperModel paperModel(NamedMesh named) {
    PaperModel model{std::move(named.name), scenes::normalised(std::move(named.mesh)), {}, {}};
    const MeshReport report = inspect(model.mesh.view());
    model.mesh = scenes::scaled(std::move(model.mesh), 2 / (report.upper - report.lower).maxCoeff());
    const reference::Hierarchy hierarchy = reference::buildHierarchy(model.mesh.view());
    model.boxes = reference::bounded<reference::Box>(hierarchy);
    model.dops = reference::bounded<PaperDop>(hierarchy);
    return model;
}

std::vector<NamedMesh> fittedShapes(bool quick) {
    if (quick) {
        return {{"bumpySphere", scenes::bumpySphere(1, 0.22F, 9, 6, 6151)},
                {"gear", scenes::gear(1, 0.14F, 0.31F, 0.37F, 13, 1)}};
    }
    return {{"bumpySphere", scenes::bumpySphere(1, 0.22F, 9, 20, 6151)},
            {"gear", scenes::gear(1, 0.14F, 0.31F, 0.37F, 19, 3)}};
}

std::vector<NamedMesh> shownShapes(bool quick) {
    if (quick) {
        return {{"cup", scenes::cup(0.7F, 0.09F, 1.3F, 20, 6)}, {"rings", rings(6, 12)}};
    }
    return {{"cup", scenes::cup(0.7F, 0.09F, 1.3F, 72, 24)},
            {"torusKnot", scenes::torusKnot(3, 5, 1, 0.42F, 0.13F, 400, 14)},
            {"spikedBall", scenes::spikedBall(1, 0.38F, 46, 12'000)},
            {"rings", rings(24, 32)}};
}

Turns turns(const DistanceRange& range, int steps) {
    Turns result;
    const int last = static_cast<int>(std::floor((range.high - range.low) / range.step + 1e-9));
    for (int i = 0; i <= last; ++i) {
        const double distance = range.low + i * range.step;
        result.distances.push_back(distance);
        std::vector<Pose>& poses = result.poses.emplace_back();
        for (int step = 0; step < steps; ++step) {
            const double angle = 2 * std::numbers::pi * step / steps;
            const Eigen::Quaterniond turn = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()) *
                                            Eigen::AngleAxisd(7 * angle, Eigen::Vector3d::UnitZ());
            poses.push_back({turn.toRotationMatrix().cast<float>(), {static_cast<float>(distance), 0, 0}});
        }
    }
    return result;
}

}  // namespace grapeshot::bench
