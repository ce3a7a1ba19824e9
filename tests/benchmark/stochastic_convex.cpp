#include "stochastic_convex.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <numbers>

#include <grapeshot/scf/reference/lin_canny.hpp>
#include <scenes/shapes.hpp>

namespace grapeshot::bench {

namespace {

using scf::reference::ClosestFeatures;
using scf::reference::ConvexPolyhedron;
using scf::reference::LinCanny;

Pose circling(double angle) {
    const auto turn = static_cast<float>(angle);
    const Eigen::Matrix3f rotation =
        Eigen::AngleAxisf(1.7F * turn, Eigen::Vector3f(1, 2, 3).normalized()).toRotationMatrix();
    return {rotation, {2.2F * std::cos(turn), 2.2F * std::sin(turn), 0.3F}};
}

report::Row rowOf(const ConvexPolyhedron& body, bool coherent, double degrees, int poses) {
    report::Row row;
    row.scenario = "convex";
    row.mesh = "sphere";
    row.triangles = body.faces.size();
    row.method = coherent ? "Lin-Canny, from the last features" : "Lin-Canny, from the first vertices";
    row.n = static_cast<std::size_t>(poses);
    LinCanny query(body, body, {.coherent = coherent});
    static_cast<void>(query.closest(circling(0)));
    std::vector<double> times;
    double steps = 0;
    int most = 0;
    for (int i = 1; i <= poses; ++i) {
        const Pose pose = circling(i * degrees * std::numbers::pi / 180);
        const auto before = std::chrono::steady_clock::now();
        const ClosestFeatures answer = query.closest(pose);
        const std::chrono::duration<double, std::micro> time = std::chrono::steady_clock::now() - before;
        times.push_back(time.count());
        steps += answer.steps;
        most = std::max(most, answer.steps);
    }
    row.timeUs = report::quantiles(times);
    row.work = {{"stepsMean", steps / poses}, {"stepsMost", static_cast<double>(most)}};
    row.measured = {{"degreesPerPose", degrees}};
    return row;
}

}  // namespace

void addConvexRows(bool quick, report::Report& results) {
    for (const int frequency : {4, 8, 16, 32}) {
        const ConvexPolyhedron body = scf::reference::convexPolyhedron(scenes::sphere(1, frequency).view());
        for (const double degrees : {0.1, 1.0, 10.0}) {
            for (const bool coherent : {true, false}) {
                results.rows.push_back(rowOf(body, coherent, degrees, quick ? 50 : 1000));
            }
        }
    }
}

}  // namespace grapeshot::bench
