#include "shot.hpp"

#include <algorithm>
#include <cmath>

namespace grapeshot::cannonball {

using Eigen::Vector3d;

Shot::Shot(const scenes::CannonballSettings& settings) : scene(scenes::makeCannonball(settings)) {
    frames.push_back(scene.world.poses());
}

void Shot::advance() {
    const auto slowest = [&](const std::vector<double>& before) {
        double share = 1;
        for (std::size_t i = 0; i < scene.balls.size(); ++i) {
            const auto now = static_cast<double>(scene.world.body(scene.balls[i]).getLinearVelocity().length());
            share = std::min(share, now / std::max(before[i], 1e-9));
        }
        return share;
    };
    std::vector<double> speeds;
    for (const std::size_t ball : scene.balls) {
        speeds.push_back(static_cast<double>(scene.world.body(ball).getLinearVelocity().length()));
    }
    records.push_back(scene.world.step());
    frames.push_back(scene.world.poses());
    if (firstImpact == 0 && slowest(speeds) < 0.9) {
        firstImpact = records.size();
    }
}

std::vector<Vector3d> path(const Shot& shot, std::size_t ball) {
    std::vector<Vector3d> points;
    for (const scenes::Frame& frame : shot.frames) {
        points.push_back(frame[shot.scene.balls[ball]].translation);
    }
    return points;
}

Depths depths(const Shot& shot, std::size_t stride) {
    std::vector<double> touching;
    for (std::size_t i = 0; i < shot.frames.size(); i += stride) {
        for (const scenes::PairDepth& pair : shot.scene.world.penetrations(shot.frames[i])) {
            if (pair.depth > 0) {
                touching.push_back(pair.depth);
            }
        }
    }
    if (touching.empty()) {
        return {};
    }
    const report::Quantiles q = report::quantiles(touching);
    return {q.max, q.p99};
}

std::vector<double> spreads(const std::vector<std::vector<std::vector<Vector3d>>>& pathsOfShots) {
    std::vector<double> result;
    if (pathsOfShots.empty()) {
        return result;
    }
    for (std::size_t ball = 0; ball < pathsOfShots.front().size(); ++ball) {
        Vector3d mean = Vector3d::Zero();
        for (const auto& paths : pathsOfShots) {
            mean += paths[ball].back() / static_cast<double>(pathsOfShots.size());
        }
        double squared = 0;
        for (const auto& paths : pathsOfShots) {
            squared += (paths[ball].back() - mean).squaredNorm() / static_cast<double>(pathsOfShots.size());
        }
        result.push_back(std::sqrt(squared));
    }
    return result;
}

}  // namespace grapeshot::cannonball
