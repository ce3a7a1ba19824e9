#include "stochastic_fit.hpp"

#include <cmath>
#include <iostream>

#include "stochastic_rows.hpp"

namespace grapeshot::bench {

using scf::reference::Settings;
using scf::reference::withHierarchy;
using scf::reference::withoutHierarchy;

namespace {

/// Root mean square over the published steps, in points of percent.
double distanceTo(const PublishedRecall& published, const Recall& recall) {
    double sum = 0;
    for (std::size_t i = 0; i < published.steps.size(); ++i) {
        const double difference = 100 * recall.share(published.steps[i]) - published.foundPercent[i];
        sum += difference * difference;
    }
    return std::sqrt(sum / static_cast<double>(published.steps.size()));
}

}  // namespace

report::Report fitStochastic(const Options& options, const PublishedRecall& withoutPublished) {
    report::Report results{
        .suite = "stochastic", .seed = options.seed, .quick = options.quick, .rows = {}, .claims = {}};
    const int episodes = options.repetitions.value_or(options.quick ? 1 : 30);
    std::vector<StochasticMethod> all;
    const auto add = [&all](const std::string& name, const Settings& settings, const FreeParameters& parameters) {
        all.push_back({name, withParameters(settings, parameters), true});
    };
    for (const int newPairs : {10, 20, 30, 40, 60}) {
        for (const int moves : {5, 10, 15, 20, 1000}) {
            add("without, " + std::to_string(newPairs) + " new, " + std::to_string(moves) + " moves",
                withoutHierarchy(), {.newPairs = newPairs, .mostMoves = moves});
        }
    }
    const std::vector<Recall> recalls = measureScenes(fittingApproaches(), all, episodes, options.seed, results);
    std::size_t nearest = 0;
    for (std::size_t m = 0; m < all.size(); ++m) {
        const double distance = distanceTo(withoutPublished, recalls[m]);
        std::cerr << all[m].name << ": " << distance << " points from the published row\n";
        nearest = distance < distanceTo(withoutPublished, recalls[nearest]) ? m : nearest;
    }
    FreeParameters parameters{all[nearest].settings.newPairs, all[nearest].settings.mostMoves};
    std::cerr << "nearest: " << all[nearest].name << "\n";
    all.clear();
    for (const int depth : {2, 3, 4, 5, 6, 7, 8, 9, 10}) {
        parameters.depth = depth;
        add("with, depth " + std::to_string(depth), withHierarchy(), parameters);
    }
    static_cast<void>(measureScenes(fittingApproaches(), all, episodes, options.seed, results));
    return results;
}

}  // namespace grapeshot::bench
