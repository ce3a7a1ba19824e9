// The experiment is that of:
// Stefan Kimmerle, Matthieu Nesme, Francois Faure. Hierarchy Accelerated Stochastic Collision Detection. VMV 2004
#include "stochastic_suite.hpp"

#include <stdexcept>

#include "stochastic_convex.hpp"
#include "stochastic_fit.hpp"
#include "stochastic_plots.hpp"
#include "stochastic_rows.hpp"

namespace grapeshot::bench {

namespace {

void addPublishedRows(const std::vector<PublishedRecall>& published, report::Report& results) {
    for (const PublishedRecall& one : published) {
        report::Row row;
        row.scenario = "published";
        row.method = one.method;
        for (std::size_t i = 0; i < one.steps.size(); ++i) {
            row.measured.emplace_back("found" + std::to_string(one.steps[i]) + "Pct", one.foundPercent[i]);
        }
        results.rows.push_back(row);
    }
}

}  // namespace

report::Report runStochasticSuite(const Options& options) {
    const std::vector<PublishedRecall> published = readPublishedRecall(GRAPESHOT_PUBLISHED_RECALL);
    if (options.scenarios == std::vector<std::string>{"fit"}) {
        return fitStochastic(options, published.back());
    }
    if (!options.scenarios.empty()) {
        throw std::invalid_argument("--scenario: '" + options.scenarios.front() + "' is not fit");
    }
    report::Report results{
        .suite = "stochastic", .seed = options.seed, .quick = options.quick, .rows = {}, .claims = {}};
    addPublishedRows(published, results);
    addConvexRows(options.quick, results);
    const std::vector<StochasticMethod> all = stochasticMethods();
    const int episodes = options.repetitions.value_or(options.quick ? 1 : 60);
    const std::vector<Recall> recalls = measureScenes(reportedApproaches(), all, episodes, options.seed, results);
    if (!options.plotFolder.empty()) {
        drawStochasticPlots(all, recalls, published, options.plotFolder);
    }
    std::size_t outside = 0;
    for (std::size_t m = 0; m < all.size(); ++m) {
        outside += all[m].settings.collisionTest == scf::reference::CollisionTest::triangles ? recalls[m].outside : 0;
    }
    results.claims.push_back(
        {"reported pairs farther apart than the distance", static_cast<double>(outside), false, 0});
    results.claims.push_back({"regions found without hierarchy", static_cast<double>(recalls[1].found[1]), true, 1});
    if (!options.quick) {
        const Recall& with = recalls[0];
        const Recall& without = recalls[1];
        results.claims.push_back(
            {"first-step misses, with / without hierarchy", (1 - with.share(1)) / (1 - without.share(1)), false, 0.5});
        results.claims.push_back({"steps to 98 %, with / without hierarchy",
                                  static_cast<double>(with.stepsTo(0.98)) / static_cast<double>(without.stepsTo(0.98)),
                                  false, 0.5});
    }
    return results;
}

}  // namespace grapeshot::bench
