#include "instrument.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace grapeshot::intestine {

using Eigen::Vector3d;

namespace {

constexpr double rodRadius = 0.06;   // m
constexpr double bendRadius = 0.24;  // m: a strand fits in
constexpr double shaft = 2.5;        // m
constexpr double tip = 0.15;         // m

std::vector<Vector3d> bentLine(double spacing) {
    std::vector<Vector3d> line;
    const int down = static_cast<int>(std::ceil(shaft / spacing));
    for (int i = 0; i < down; ++i) {
        line.emplace_back(0, bendRadius + shaft * (down - i) / down, 0);
    }
    const int bend = static_cast<int>(std::ceil(std::numbers::pi * bendRadius / spacing));
    for (int i = 0; i <= bend; ++i) {
        const double angle = std::numbers::pi * i / bend;
        line.emplace_back(bendRadius * (1 - std::cos(angle)), bendRadius * (1 - std::sin(angle)), 0);
    }
    const int up = static_cast<int>(std::ceil(tip / spacing));
    for (int i = 1; i <= up; ++i) {
        line.emplace_back(2 * bendRadius, bendRadius + tip * i / up, 0);
    }
    return line;
}

double smooth(double t) {
    t = std::clamp(t, 0.0, 1.0);
    return t * t * (3 - 2 * t);
}

}  // namespace

scenes::Mesh hook(int around) {
    const std::vector<Vector3d> line = bentLine(2 * std::numbers::pi * rodRadius / around);
    scenes::Mesh mesh;
    for (std::size_t i = 0; i < line.size(); ++i) {
        const Vector3d along = (line[std::min(i + 1, line.size() - 1)] - line[i > 0 ? i - 1 : 0]).normalized();
        const Vector3d across = along.cross(Vector3d::UnitZ());
        for (int k = 0; k < around; ++k) {
            const double angle = 2 * std::numbers::pi * k / around;
            mesh.vertices.emplace_back(
                (line[i] + rodRadius * (std::cos(angle) * across + std::sin(angle) * Vector3d::UnitZ())).cast<float>());
        }
    }
    const auto n = static_cast<std::uint32_t>(around);
    const auto last = static_cast<std::uint32_t>(line.size()) - 1;
    for (std::uint32_t i = 0; i < last; ++i) {
        for (std::uint32_t k = 0; k < n; ++k) {
            const std::uint32_t a = i * n + k;
            const std::uint32_t b = i * n + (k + 1) % n;
            mesh.triangles.push_back({a, b, b + n});
            mesh.triangles.push_back({a, b + n, a + n});
        }
    }
    for (const std::uint32_t end : {std::uint32_t{0}, last}) {
        const auto centre = static_cast<std::uint32_t>(mesh.vertices.size());
        mesh.vertices.emplace_back(line[end].cast<float>());
        for (std::uint32_t k = 0; k < n; ++k) {
            const std::uint32_t a = end * n + k;
            const std::uint32_t b = end * n + (k + 1) % n;
            mesh.triangles.push_back(end == 0 ? Triangle{centre, b, a} : Triangle{centre, a, b});
        }
    }
    return mesh;
}

scenes::PoseD instrumentPose(double progress, const Operation& operation) {
    // Shares of the operation, heights above the spot and ways aside, m, and how far the hook's tip is turned from the
    // strand's direction to the strand.
    struct Key {
        double at, up, side, turn;
    };
    constexpr std::array<Key, 8> keys{{{0, 3, 0, 0},
                                       {begin, 3, 0, 0},
                                       {0.4, 0, 0, 0},       // down, in the gap
                                       {0.5, 0, 0, 1},       // the tip goes below the strand
                                       {0.6, 0.05, 0.4, 1},  // push
                                       {0.75, 1.0, 0.4, 1},  // lift
                                       {0.87, 0.1, 0.1, 0},  // back, and the tip out
                                       {1, 2.8, -0.1, 0}}};  // withdraw
    std::size_t i = 1;
    while (i + 1 < keys.size() && progress > keys[i].at) {
        ++i;
    }
    const Key& from = keys[i - 1];
    const Key& to = keys[i];
    const double t = smooth((progress - from.at) / (to.at - from.at));
    const auto mixed = [t](double a, double b) { return a + t * (b - a); };
    const double turn = (1 - mixed(from.turn, to.turn)) * std::numbers::pi / 2;
    const Vector3d& aside = operation.aside;
    const Vector3d along = aside.cross(Vector3d::UnitY());
    scenes::PoseD pose;
    pose.rotation.col(0) = std::cos(turn) * aside + std::sin(turn) * along;
    pose.rotation.col(1) = Vector3d::UnitY();
    pose.rotation.col(2) = pose.rotation.col(0).cross(Vector3d::UnitY());
    pose.translation = operation.spot + mixed(from.up, to.up) * Vector3d::UnitY() + mixed(from.side, to.side) * aside;
    return pose;
}

}  // namespace grapeshot::intestine
