// Two small bodies in contact, and runs over a short motion.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include <grapeshot/scf/reference/active_pairs.hpp>
#include <scenes/shapes.hpp>

namespace grapeshot::test {

using scf::reference::Settings;
using scf::reference::State;
using scf::reference::StepResult;
using scf::reference::Surface;

inline std::vector<Eigen::Vector3f> placed(const scenes::Mesh& mesh, const Eigen::Vector3f& offset, float angle = 0) {
    const Eigen::Matrix3f rotation =
        Eigen::AngleAxisf(angle, Eigen::Vector3f(1, 2, -1).normalized()).toRotationMatrix();
    std::vector<Eigen::Vector3f> vertices;
    for (const Eigen::Vector3f& vertex : mesh.vertices) {
        vertices.push_back(rotation * vertex + offset);
    }
    return vertices;
}

/// Two trefoil knots of 960 triangles: many minima of the distance. B comes from +x.
struct Bodies {
    scenes::Mesh mesh = scenes::normalised(scenes::torusKnot(2, 3, 1, 0.4F, 0.2F, 60, 8));
    Surface a = scf::reference::buildSurface(mesh.view());
    Surface b = a;
    std::vector<Eigen::Vector3f> atA = placed(mesh, Eigen::Vector3f::Zero());

    /// In contact from 1.24 on, at several places below 1.1.
    [[nodiscard]] std::vector<Eigen::Vector3f> atB(float distance) const {
        return placed(mesh, {distance, 0.05F, 0}, 0.4F);
    }
    StepResult step(const Settings& settings, State& state, float distance) const {
        return scf::reference::step(a, b, atA, atB(distance), settings, state);
    }
};

inline const Bodies& bodies() {
    static const Bodies both;
    return both;
}

/// From apart to 0.3 m deep.
inline constexpr int approachSteps = 12;
inline float distanceAt(int step) {
    return 1.4F - 0.04F * static_cast<float>(step);
}

struct History {
    State state;
    std::vector<StepResult> results;
};

inline History approach(const Bodies& bodies, const Settings& settings) {
    History history;
    for (int i = 0; i < approachSteps; ++i) {
        history.results.push_back(bodies.step(settings, history.state, distanceAt(i)));
    }
    return history;
}

}  // namespace grapeshot::test
