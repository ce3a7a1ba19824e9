#include "stochastic_methods.hpp"

#include <functional>

namespace grapeshot::bench {

using scf::reference::Settings;
using scf::reference::withHierarchy;
using scf::reference::withoutHierarchy;

Settings withParameters(Settings settings, const FreeParameters& parameters) {
    settings.newPairs = parameters.newPairs;
    settings.mostMoves = parameters.mostMoves;
    settings.hierarchyDepth = parameters.depth;
    settings.maxDistance = parameters.maxDistance;
    return settings;
}

std::vector<StochasticMethod> stochasticMethods(const FreeParameters& parameters) {
    std::vector<StochasticMethod> all;
    const auto add = [&](const char* name, const Settings& base, const std::function<void(Settings&)>& change = {}) {
        StochasticMethod method{name, withParameters(base, parameters), true};
        if (change) {
            change(method.settings);
        }
        all.push_back(method);
    };
    add("with hierarchy", withHierarchy());
    add("without", withoutHierarchy());
    add("with, full update", withHierarchy(), [](Settings& s) { s.update = scf::reference::Update::full; });
    add("with, half uniform", withHierarchy(), [](Settings& s) { s.hierarchyShare = 0.5; });
    const int toConvergence = Settings().mostMoves;
    add("with, to convergence", withHierarchy(), [&](Settings& s) { s.mostMoves = toConvergence; });
    add("with, to convergence, 60 new", withHierarchy(), [&](Settings& s) {  // the work of "without, to convergence"
        s.mostMoves = toConvergence;
        s.newPairs = 60;
    });
    add("with, one move a step", withHierarchy(), [](Settings& s) { s.mostMoves = 1; });
    add("with, within overlap", withHierarchy(), [](Settings& s) { s.tries = 16; });
    add("with, spread", withHierarchy(), [](Settings& s) { s.spread = true; });
    add("with, nothing removed", withHierarchy(), [](Settings& s) { s.removeFar = false; });
    add("with, neighbours redundant", withHierarchy(),
        [](Settings& s) { s.redundancy = scf::reference::Redundancy::neighbours; });
    add("with, sum of radii", withHierarchy(),
        [](Settings& s) { s.collisionTest = scf::reference::CollisionTest::radii; });
    add("with, no memory", withHierarchy());
    all.back().remembers = false;
    add("without, velocity", withoutHierarchy(), [](Settings& s) { s.velocityShare = 1; });
    add("without, multires", withoutHierarchy(), [](Settings& s) { s.multires = true; });
    add("without, velocity, multires", withoutHierarchy(), [](Settings& s) {
        s.velocityShare = 1;
        s.multires = true;
    });
    add("without, to convergence", withoutHierarchy(), [&](Settings& s) { s.mostMoves = toConvergence; });
    add("without, one move a step", withoutHierarchy(), [](Settings& s) { s.mostMoves = 1; });
    add("without, no memory", withoutHierarchy());
    all.back().remembers = false;
    return all;
}

}  // namespace grapeshot::bench
