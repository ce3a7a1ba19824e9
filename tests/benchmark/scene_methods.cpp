#include "scene_methods.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iostream>
#include <memory>
#include <numeric>

#include <grapeshot/narrowphase/feature_model.hpp>
#include <grapeshot/plugin/detail/shape_models.hpp>
#include <grapeshot/plugin/registration.hpp>
#include <grapeshot/plugin/shape_cache.hpp>
#include <grapeshot/plugin/statistics.hpp>
#include <scenes/cannonball.hpp>
#include <support/rest_scenes.hpp>

#include "pile_scene.hpp"
#include "scene_pairs.hpp"
#include "scene_regions.hpp"

namespace grapeshot::bench {

using scenes::Engine;
using scenes::World;

namespace {

/// A way to find the contacts.
struct Way {
    std::string name;
    Settings settings;
};

std::vector<Way> ways() {
    std::vector<Way> all(4);
    all[0] = {"adb", {}};
    all[0].settings.method = Method::adb;
    all[1] = {"scf", {}};
    all[1].settings.method = Method::scf;
    all[2] = {"automatic", {}};
    // So little that whatever is tangled is sampled.
    all[3] = {"scf, sampled", all[1].settings};
    all[3].settings.searchWork = 512;
    return all;
}
constexpr std::size_t automaticWay = 2;
constexpr std::size_t sampledWay = 3;

struct Scene {
    std::string name;
    int steps = 240;
    std::function<World()> make;
};

/// What a run has left behind.
struct Outcome {
    std::vector<double> us;  ///< per step, the least of all runs
    double work = 0, contacts = 0, pairs = 0, tracked = 0, sampled = 0, refreshed = 0, leftToAdb = 0;  ///< sums
    double lost = 0;
    RegionCounts regions;
};

World makeWorld(const Scene& scene, const Way& way) {
    World world = scene.make();
    static_cast<void>(registerAlgorithms(&world.dispatcher(), way.settings));
    for (std::size_t body = 0; body < world.bodies(); ++body) {
        static_cast<void>(prebuild(world.body(body).getCollisionShape(), way.settings.method));  // solids need none
    }
    return world;
}

void note(const StepStatistics& step, Outcome& outcome) {
    outcome.work += static_cast<double>(step.work);
    outcome.contacts += step.contacts;
    outcome.pairs += static_cast<double>(step.pairs.size());
    outcome.tracked += step.tracked;
    outcome.sampled += step.sampled;
    outcome.refreshed += step.refreshed;
    outcome.leftToAdb += step.leftToAdb;
}

/// All ways step by step in turns, so that whatever else the machine does hits them alike.
void runInTurns(const Scene& scene, const std::vector<Way>& all, bool first, std::vector<Outcome>& outcomes) {
    std::vector<World> worlds;
    for (const Way& way : all) {
        worlds.push_back(makeWorld(scene, way));
    }
    for (int step = 0; step < scene.steps; ++step) {
        for (std::size_t i = 0; i < all.size(); ++i) {
            const scenes::StepRecord record = worlds[i].step();
            const double us = record.narrowphaseCpuSeconds * 1e6;
            if (first) {
                outcomes[i].us.push_back(us);
                outcomes[i].lost = record.lost;
                note(statistics(&worlds[i].dispatcher()), outcomes[i]);
            } else {
                double& least = outcomes[i].us[static_cast<std::size_t>(step)];
                least = std::min(least, us);
            }
        }
    }
}

RegionCounts regionsOf(const Scene& scene, const Way& way) {
    World world = makeWorld(scene, way);
    RegionWatch watch(way.settings);
    for (int step = 0; step < scene.steps; ++step) {
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

double total(const Outcome& outcome) {
    return std::accumulate(outcome.us.begin(), outcome.us.end(), 0.0);
}

report::Row rowOf(const Scene& scene, const Way& way, const Outcome& outcome, double best) {
    const auto steps = static_cast<double>(outcome.us.size());
    const RegionCounts& regions = outcome.regions;
    const auto count = static_cast<double>(regions.regions);
    report::Row row;
    row.scenario = "methods";
    row.mesh = scene.name;
    row.method = way.name;
    row.peer = "best alone";
    row.n = outcome.us.size();
    row.timeUs = report::quantiles(outcome.us);
    row.ratio = best / total(outcome);
    row.work = {{"units", outcome.work / steps}, {"contacts", outcome.contacts / steps}};
    row.measured = {{"lost", outcome.lost},
                    {"byScf", share(outcome.tracked, outcome.pairs)},
                    {"sampled", share(outcome.sampled, outcome.pairs)},
                    {"leftToAdb", outcome.leftToAdb},
                    {"regions", count},
                    {"atFirst", share(static_cast<double>(regions.atFirst), count)},
                    {"withinTwo", share(static_cast<double>(regions.withinTwo), count)},
                    {"forceErrorP99", report::quantile(regions.forceErrors, 0.99)},
                    {"force10", atMost(regions.forceErrors, 0.1)},
                    {"torque10", atMost(regions.torqueErrors, 0.1)}};
    return row;
}

void runScene(const Scene& scene, const Options& options, report::Report& results) {
    const std::vector<Way> all = ways();
    std::vector<Outcome> outcomes(all.size());
    const int repetitions = options.repetitions.value_or(options.quick ? 1 : 3);
    for (int repetition = 0; repetition < repetitions; ++repetition) {
        std::cerr << "methods: " << scene.name << ", run " << repetition + 1 << " of " << repetitions << '\n';
        runInTurns(scene, all, repetition == 0, outcomes);
    }
    for (std::size_t i = 0; i < all.size(); ++i) {
        outcomes[i].regions = regionsOf(scene, all[i]);
    }
    const double best = std::min(total(outcomes[0]), total(outcomes[1]));
    for (std::size_t i = 0; i < all.size(); ++i) {
        results.rows.push_back(rowOf(scene, all[i], outcomes[i], best));
        const std::string label = scene.name + " by " + all[i].name + ": ";
        const RegionCounts& regions = outcomes[i].regions;
        const auto count = static_cast<double>(regions.regions);
        results.claims.push_back({label + "bodies lost", outcomes[i].lost, false, 0});
        if (count > 0) {
            results.claims.push_back({label + "share of regions found within two steps",
                                      share(static_cast<double>(regions.withinTwo), count), true, 0.99});
        }
        if (i == sampledWay && !regions.forceErrors.empty()) {
            results.claims.push_back({label + "hits whose force is that of the whole patch within 10 %",
                                      atMost(regions.forceErrors, 0.1), true, 0.95});
            results.claims.push_back({label + "hits whose torque is that of the whole patch within 10 %",
                                      atMost(regions.torqueErrors, 0.1), true, 0.95});
        }
    }
    if (!options.quick) {
        results.claims.push_back({scene.name + ": automatic's narrowphase time / that of the best alone",
                                  total(outcomes[automaticWay]) / best, false, 1.15});
    }
}

template <class T>
double bytes(const std::vector<T>& values) {
    return static_cast<double>(values.size() * sizeof(T));
}

/// Bytes per triangle of a body of the pile: what everybody pays, and what Method::scf adds.
void measureMemory(const Scene& scene, report::Report& results) {
    const World world = scene.make();
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

std::vector<Scene> scenesOf(const Options& options) {
    PileSettings pile;
    pile.seed = options.seed;
    if (options.quick) {
        pile.bodies = 12;
        pile.trianglesPerBody = 1200;
    }
    std::vector<Scene> all;
    all.push_back({"pile", options.quick ? 100 : 240, [pile] { return makePile({}, pile); }});
    for (const test::RestScene rest :
         {test::RestScene::uOnBar, test::RestScene::crossInHole, test::RestScene::interlockedTori}) {
        all.push_back({std::string(test::name(rest)), options.quick ? 60 : 600, [rest] {
                           World world(test::undamped(Engine::grapeshot, 0.02));
                           addRestScene(world, rest);
                           return world;
                       }});
    }
    all.push_back({"cannonball", options.quick ? 60 : 240, [] { return scenes::makeCannonball().world; }});
    return all;
}

}  // namespace

void runMethods(const Options& options, report::Report& results) {
    const std::vector<Scene> all = scenesOf(options);
    for (const Scene& scene : all) {
        runScene(scene, options, results);
    }
    measurePairs(options, results);
    measureMemory(all.front(), results);
}

}  // namespace grapeshot::bench
