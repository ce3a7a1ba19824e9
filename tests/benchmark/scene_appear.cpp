#include "scene_appear.hpp"

#include <BulletCollision/Gimpact/btGImpactShape.h>
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <cmath>
#include <list>
#include <string>
#include <vector>

#include <grapeshot/plugin.hpp>

#include <report/machine.hpp>
#include <scenes/shapes.hpp>
#include <scenes/triangle_arrays.hpp>

#include "scene_rows.hpp"

namespace grapeshot::bench {

namespace {

constexpr std::uint64_t budget = 5000;
constexpr double secondsPerUnit = 0.2e-6;
constexpr float radius = 0.5F;  // m

float heightAt(float x, float z) {
    return 0.02F * std::sin(3 * x) * std::sin(2.7F * z);
}

scenes::Mesh ground(int cells) {
    scenes::Mesh mesh = scenes::grid(4, 4, cells, cells);
    for (Eigen::Vector3f& vertex : mesh.vertices) {
        vertex.y() = heightAt(vertex.x(), vertex.z());
    }
    return mesh;
}

struct Watch {
    std::vector<double> stepUs;
    double work = 0;
    double over = 0;     ///< steps that cost more than the budget and the mandatory part
    double deepest = 0;  ///< of the balls' centres below where they should be, m
    int stepsToFull = 0;
};

Watch watch(int cells, int mostSteps, Method method) {
    const scenes::Mesh floorMesh = ground(cells);
    const scenes::Mesh ballMesh = scenes::sphere(radius, 6);
    const auto floorArrays = scenes::arraysOf(floorMesh.view());
    const auto ballArrays = scenes::arraysOf(ballMesh.view());
    btBvhTriangleMeshShape floor(floorArrays.get(), true);
    btGImpactMeshShape ball(ballArrays.get());
    floor.setMargin(0.02F);
    ball.setMargin(0.02F);
    ball.updateBound();
    btDefaultCollisionConfiguration configuration;
    Dispatcher dispatcher(&configuration);
    Settings settings;
    settings.frameBudget.work = budget;
    settings.method = method;
    registerAlgorithms(&dispatcher, settings);
    btDbvtBroadphase broadphase;
    btSequentialImpulseConstraintSolver solver;
    btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);
    btRigidBody floorBody(0, nullptr, &floor);
    std::list<btRigidBody> balls;
    const btVector3 inertia = massProperties(&ball, 1).inertia;
    for (int i = 0; i < 6; ++i) {
        btRigidBody& body = balls.emplace_back(1, nullptr, &ball, inertia);
        body.translate({1.3F * static_cast<float>(i % 3) - 1.4F, 0.62F, 1.5F * static_cast<float>(i / 3) - 0.7F});
        body.setAngularFactor(0);  // they would roll away
        body.setDamping(0.2F, 0);
        body.setActivationState(DISABLE_DEACTIVATION);
        world.addRigidBody(&body);
    }
    constexpr btScalar timeStep = 1.0F / 60;
    world.stepSimulation(timeStep, 0);
    world.addRigidBody(&floorBody);
    Watch seen;
    bool full = false;
    const auto step = [&] {
        const double begin = report::threadCpuUs();
        world.stepSimulation(timeStep, 0);
        const double us = report::threadCpuUs() - begin;
        const StepStatistics& last = statistics(&dispatcher);
        seen.over += last.work > std::max(last.budget, last.mandatory) ? 1 : 0;
        for (const btRigidBody& body : balls) {
            const btVector3 at = body.getCenterOfMassPosition();
            const float resting = heightAt(static_cast<float>(at.x()), static_cast<float>(at.z())) + radius;
            seen.deepest = std::max(seen.deepest, static_cast<double>(resting) - static_cast<double>(at.y()));
        }
        if (!full) {
            seen.stepUs.push_back(us);
            seen.work += static_cast<double>(last.work);
            full = !last.pairs.empty() && last.degraded == 0;
        }
    };
    while (!full && static_cast<int>(seen.stepUs.size()) < mostSteps) {
        step();
    }
    seen.stepsToFull = static_cast<int>(seen.stepUs.size());
    for (int i = 0; i < 60; ++i) {
        step();
    }
    return seen;
}

}  // namespace

namespace {

void appear(const char* label, Method method, int cells, double mostSeconds, const Options& options,
            report::Report& results) {
    const auto triangles = static_cast<std::size_t>(2 * cells * cells);
    const double mostUnits = mostSeconds / secondsPerUnit;
    const int mostSteps = static_cast<int>(4 * std::max(mostUnits, 20.0 * static_cast<double>(triangles)) / budget);
    Watch seen = watch(cells, mostSteps, method);
    double cpu = 0;
    for (const double us : seen.stepUs) {
        cpu += us * 1e-6;
    }
    report::Row row;
    row.scenario = "appear";
    row.mesh = "ground";
    row.triangles = triangles;
    row.method = std::string("budget 5000, ").append(name(method));
    row.n = seen.stepUs.size();
    row.timeUs = report::quantiles(seen.stepUs);
    row.work = {{"mean", seen.work / static_cast<double>(seen.stepsToFull)}};
    row.measured = {{"stepsToFull", seen.stepsToFull},
                    {"secondsOfWork", seen.work * secondsPerUnit},
                    {"processorSeconds", cpu},
                    {"deepest", seen.deepest}};
    results.rows.push_back(row);
    Claims claims(label, results);
    claims.atMost("steps until full quality, of most", seen.stepsToFull, mostSteps - 1);
    claims.atMost("steps over the budget and the mandatory part", seen.over, 0);
    claims.atMost("deepest of the balls below the surface / radius", seen.deepest / static_cast<double>(radius), 0.05);
    claims.atMost("seconds of work until full quality", seen.work * secondsPerUnit, mostSeconds);
    if (!options.quick) {
        claims.atMost("processor time until full quality, s", cpu, mostSeconds);
    }
}

}  // namespace

void runAppear(const Options& options, report::Report& results) {
    appear("appear", Method::automatic, options.quick ? 90 : 708, 2, options, results);
    // Ball trees cost five times as much as the others: two seconds are for a fifth of the triangles.
    appear("appear by scf", Method::scf, options.quick ? 60 : 317, 2, options, results);
}

}  // namespace grapeshot::bench
