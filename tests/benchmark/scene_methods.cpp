#include "scene_methods.hpp"

#include <algorithm>
#include <initializer_list>
#include <numeric>
#include <utility>

#include <grapeshot/narrowphase/feature_model.hpp>
#include <grapeshot/plugin/detail/shape_models.hpp>
#include <grapeshot/plugin/shape_cache.hpp>

#include "method_scenes.hpp"
#include "scene_pairs.hpp"
#include "scene_regions.hpp"
#include "scene_rows.hpp"
#include "scene_run.hpp"

namespace grapeshot::bench {

using scenes::World;
using scenes::WorldSettings;

namespace {

/// Who the others are compared with, and what is claimed of them.
enum WayIndex : std::size_t { adbWay, scfWay, automaticWay, sampledWay };

SceneMethod way(std::string name, Method method, int runs) {
    SceneMethod one = grapeshotMethod(runs);
    one.name = std::move(name);
    one.world.settings.method = method;
    return one;
}

/// In the order of WayIndex.
std::vector<SceneMethod> ways(int runs) {
    std::vector<SceneMethod> all{way("adb", Method::adb, runs), way("scf", Method::scf, runs),
                                 way("automatic", Method::automatic, runs), way("scf, sampled", Method::scf, runs)};
    all[sampledWay].world.settings.searchWork = 512;  // so little that whatever is tangled is sampled
    return all;
}

World makeWorld(const MethodScene& scene, const WorldSettings& method) {
    World world = scene.make(method);
    for (std::size_t body = 0; body < world.bodies(); ++body) {
        // Solids need none.
        static_cast<void>(prebuild(world.body(body).getCollisionShape(), method.settings.method));
    }
    return world;
}

RegionCounts regionsOf(const MethodScene& scene, const WorldSettings& method) {
    World world = makeWorld(scene, method);
    RegionWatch watch(method.settings);
    const auto steps = std::lround(scene.seconds / scene.timeStep);
    for (long step = 0; step < steps; ++step) {
        watch.before(world);
        world.step();
        watch.after(world);
    }
    return watch.counts();
}

double share(double part, double whole) {
    return whole > 0 ? part / whole : report::notApplicable;
}

double atMost(const std::vector<double>& values, double limit) {
    const auto below = std::ranges::count_if(values, [&](double value) { return value <= limit; });
    return share(static_cast<double>(below), static_cast<double>(values.size()));
}

/// Of all steps, each the least of all runs.
double totalUs(const Outcome& outcome) {
    const std::vector<double>& us = outcome.recorder.run().narrowphaseUs;
    return std::accumulate(us.begin(), us.end(), 0.0);
}

void addMeasured(const Outcome& outcome, const RegionCounts& regions, report::Row& row) {
    StepWork sum;
    for (const StepWork& step : outcome.recorder.run().work) {
        sum.pairs += step.pairs;
        sum.tracked += step.tracked;
        sum.sampled += step.sampled;
        sum.leftToAdb += step.leftToAdb;
    }
    const auto pairs = static_cast<double>(sum.pairs);
    const auto count = static_cast<double>(regions.regions);
    for (const auto& [name, value] : std::initializer_list<std::pair<std::string, double>>{
             {"byScf", share(sum.tracked, pairs)},
             {"sampled", share(sum.sampled, pairs)},
             {"leftToAdb", sum.leftToAdb},
             {"regions", count},
             {"atFirst", share(static_cast<double>(regions.atFirst), count)},
             {"withinTwo", share(static_cast<double>(regions.withinTwo), count)},
             {"forceErrorP99", report::quantile(regions.forceErrors, 0.99)},
             {"force10", atMost(regions.forceErrors, 0.1)},
             {"torque10", atMost(regions.torqueErrors, 0.1)}}) {
        row.measured.emplace_back(name, value);
    }
}

/// What a motion has to be by any method; `usual` is adb's.
void claimMotion(const MethodScene& scene, const Outcome& outcome, const Quality& quality, const Quality& usual,
                 Claims& claims) {
    claims.atMost("p99 of true penetration / radius", quality.bodyDepth.p99, 0.01);
    if (scene.faults) {
        claims.atMost(scene.fault, scene.faults(outcome.recorder.world()), 0);
    }
    if (scene.rests) {
        claims.atMost("residual RMS speed - adb's, m/s", quality.residualSpeed - usual.residualSpeed, 0.005);
    }
}

void runScene(const MethodScene& scene, const Options& options, report::Report& results) {
    std::vector<SceneMethod> all = ways(options.repetitions.value_or(options.quick ? 1 : 3));
    for (SceneMethod& method : all) {
        method.world.timeStep = scene.timeStep;
    }
    const Course course{
        .scenario = "methods: " + scene.name, .seconds = scene.seconds, .frameSeconds = scene.frameSeconds};
    const std::vector<Outcome> outcomes =
        runInTurns(course, all, [&](const WorldSettings& method) { return makeWorld(scene, method); });
    const double best = std::min(totalUs(outcomes[adbWay]), totalUs(outcomes[scfWay]));
    const Quality usual = judge(outcomes[adbWay]);
    for (std::size_t i = 0; i < all.size(); ++i) {
        const Outcome& outcome = outcomes[i];
        const Quality quality = i == adbWay ? usual : judge(outcome);
        const RegionCounts regions = regionsOf(scene, all[i].world);
        report::Row row = rowOf("methods", scene.name, outcome, quality);
        row.peer = "best alone";
        row.ratio = best / totalUs(outcome);
        addMeasured(outcome, regions, row);
        if (scene.faults) {
            row.measured.emplace_back("faults", scene.faults(outcome.recorder.world()));
        }
        results.rows.push_back(std::move(row));
        Claims claims(scene.name + " by " + all[i].name, results);
        claims.atMost("bodies lost", quality.lost, 0);
        if (!options.quick) {  // else nothing has come to rest
            claimMotion(scene, outcome, quality, usual, claims);
        }
        if (regions.regions > 0) {
            claims.atLeast("share of regions found within two steps",
                           share(static_cast<double>(regions.withinTwo), static_cast<double>(regions.regions)), 0.99);
        }
        const bool isJudged = i == sampledWay || (i == scfWay && !options.quick);
        if (isJudged && !(options.quick && scene.isTangled) && !regions.forceErrors.empty()) {
            claims.atLeast("hits whose force is that of the whole patch within 10 %", atMost(regions.forceErrors, 0.1),
                           0.95);
            claims.atLeast("hits whose torque is that of the whole patch within 10 %",
                           atMost(regions.torqueErrors, 0.1), 0.95);
        }
    }
    if (!options.quick) {
        Claims(scene.name, results)
            .atMost("automatic's narrowphase time / that of the best alone", totalUs(outcomes[automaticWay]) / best,
                    1.15);
    }
}

template <class T>
double bytes(const std::vector<T>& values) {
    return static_cast<double>(values.size() * sizeof(T));
}

/// Bytes per triangle of a body of the pile: what everybody pays, and what Method::scf adds.
void measureMemory(const MethodScene& scene, report::Report& results) {
    const World world = scene.make({});
    const btCollisionShape& shape = *world.body(world.bodies() - 1).getCollisionShape();
    static_cast<void>(prebuild(&shape, Method::scf));
    const auto model = detail::ShapeModels::instance().present(shape);
    const MeshModel& mesh = *model->mesh;
    const Tree& tree = mesh.tree;
    const Topology& topology = mesh.topology;
    const double mine = bytes(tree.nodes) + bytes(tree.distributions) + bytes(tree.leaves) + bytes(tree.vertices) +
                        bytes(tree.triangles);
    const double around = bytes(topology.welded) + bytes(topology.across) + bytes(topology.ringBegin) +
                          bytes(topology.ring) + bytes(mesh.vertexNormals) + bytes(mesh.vertexCones) +
                          bytes(mesh.triangleNormals) + bytes(mesh.traits) + bytes(mesh.vertexTriangle) +
                          bytes(mesh.leafShapes) + bytes(mesh.leafOf);
    const auto balls = static_cast<double>(bytesOf(*mesh.features));
    const auto triangles = static_cast<double>(tree.triangles.size());
    report::Row row;
    row.scenario = "methods";
    row.mesh = "memory";
    row.triangles = tree.triangles.size();
    row.measured = {{"bytesAdbTree", mine / triangles},
                    {"bytesContactModel", around / triangles},
                    {"bytesBallTree", balls / triangles},
                    {"bytesBoth", (mine + around + balls) / triangles}};
    results.rows.push_back(row);
}

}  // namespace

void runMethods(const Options& options, report::Report& results) {
    const std::vector<MethodScene> all = methodScenes(options);
    for (const MethodScene& scene : all) {
        runScene(scene, options, results);
    }
    measurePairs(options, results);
    measureMemory(all.front(), results);
}

}  // namespace grapeshot::bench
