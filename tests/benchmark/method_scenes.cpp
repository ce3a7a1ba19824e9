#include "method_scenes.hpp"

#include <scenes/cannonball.hpp>
#include <support/rest_scenes.hpp>

#include "machine_scenes.hpp"
#include "pile_scene.hpp"
#include "scene_rows.hpp"

namespace grapeshot::bench {

using scenes::World;
using scenes::WorldSettings;

namespace {

constexpr double margin = sceneMargins[0];

MethodScene pile(const Options& options) {
    PileSettings pile;
    pile.seed = options.seed;
    pile.margin = margin;
    if (options.quick) {
        pile.bodies = 12;
        pile.trianglesPerBody = 1200;
    }
    MethodScene scene;
    scene.name = "pile";
    scene.make = [pile](const WorldSettings& method) { return makePile(method, pile); };
    return scene;
}

MethodScene resting(test::RestScene rest) {
    MethodScene scene;
    scene.name = test::name(rest);
    scene.seconds = 10;
    scene.rests = true;
    scene.isTangled = rest == test::RestScene::nutOnBolt;
    scene.make = [rest](const WorldSettings& method) {
        WorldSettings settings = test::undamped(method.engine, margin);
        settings.settings = method.settings;
        World world(settings);
        addRestScene(world, rest);
        return world;
    };
    return scene;
}

MethodScene machine(const MachineScene& machine) {
    MethodScene scene;
    scene.name = machine.name;
    scene.seconds = machine.seconds;
    scene.isTangled = machine.name == "stacked_cups" || machine.name == "gears";
    scene.make = [make = machine.make](const WorldSettings& method) { return make(method, margin); };
    scene.fault = machine.fault;
    scene.faults = machine.faults;
    return scene;
}

MethodScene haptic(const Options& options) {
    MethodScene scene;
    scene.name = "haptic_pair";
    scene.seconds = 0.5;
    scene.timeStep = hapticTimeStep;
    scene.frameSeconds = 0.05;
    scene.make = [triangles = hapticTriangles(options.quick)](const WorldSettings& method) {
        return makeHapticPair(method, margin, triangles);
    };
    return scene;
}

MethodScene cannonball() {
    MethodScene scene;
    scene.name = "cannonball";
    scene.timeStep = 1.0 / 120;  // as the scene has it
    scene.make = [](const WorldSettings& method) {
        scenes::CannonballSettings settings;
        settings.engine = method.engine;
        settings.settings = method.settings;
        return scenes::makeCannonball(settings).world;
    };
    return scene;
}

}  // namespace

std::vector<MethodScene> methodScenes(const Options& options) {
    std::vector<MethodScene> all{pile(options), cannonball()};
    for (const test::RestScene rest :
         {test::RestScene::uOnBar, test::RestScene::crossInHole, test::RestScene::interlockedTori,
          test::RestScene::combInRails, test::RestScene::nutOnBolt}) {
        all.push_back(resting(rest));
    }
    for (const MachineScene& one : machineScenes()) {
        all.push_back(machine(one));
    }
    all.push_back(haptic(options));
    if (options.quick) {
        for (MethodScene& scene : all) {
            scene.seconds = std::min(scene.seconds, scene.name == "pile" ? 1.5 : 0.5);
            scene.seconds = scene.timeStep < 0.002 ? 0.03 : scene.seconds;
        }
    }
    return all;
}

}  // namespace grapeshot::bench
