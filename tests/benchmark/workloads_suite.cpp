#include "workloads_suite.hpp"

#include <algorithm>
#include <iostream>
#include <stdexcept>
#include <string_view>

#include "comparison.hpp"
#include "workload_scenes.hpp"

namespace grapeshot::bench {

namespace {

struct WorkloadSizes {
    int zachmann, grazing;  ///< poses per mesh
    int unlike;             ///< questions in all
    int steps;              ///< of each path
    int hot, replays;       ///< poses per mesh, and of each
    int repetitions;
};

WorkloadSizes sizesOf(const Options& options) {
    WorkloadSizes sizes = options.quick ? WorkloadSizes{.zachmann = 1'200,
                                                        .grazing = 60,
                                                        .unlike = 300,
                                                        .steps = 240,
                                                        .hot = 24,
                                                        .replays = 10,
                                                        .repetitions = 1}
                                        : WorkloadSizes{.zachmann = 12'000,
                                                        .grazing = 1'200,
                                                        .unlike = 10'000,
                                                        .steps = 2'400,
                                                        .hot = 60,
                                                        .replays = 50,
                                                        .repetitions = 5};
    sizes.zachmann = options.poses.value_or(sizes.zachmann);
    sizes.repetitions = options.repetitions.value_or(sizes.repetitions);
    return sizes;
}

class Wanted {
  public:
    explicit Wanted(const std::vector<std::string>& scenarios) : m_scenarios(&scenarios) {
        constexpr std::string_view known[] = {"work", "unlike", "coherent", "hot"};
        for (const std::string& scenario : scenarios) {
            if (std::ranges::find(known, scenario) == std::end(known)) {
                throw std::invalid_argument("--scenario: '" + scenario + "' is not work, unlike, coherent or hot");
            }
        }
    }
    bool operator()(const std::string& scenario) const {
        return m_scenarios->empty() || std::ranges::find(*m_scenarios, scenario) != m_scenarios->end();
    }

  private:
    const std::vector<std::string>* m_scenarios;
};

double wrongOfExact(const std::vector<report::Row>& rows) {
    double wrong = 0;
    for (const report::Row& row : rows) {
        wrong += row.method.starts_with("exact") ? row.falseNegatives + row.falsePositives : 0;
    }
    return wrong;
}

}  // namespace

report::Report runWorkloadsSuite(const Options& options) {
    const Wanted wanted(options.scenarios);
    const WorkloadSizes sizes = sizesOf(options);
    report::Report results{
        .suite = "workloads", .seed = options.seed, .quick = options.quick, .rows = {}, .claims = {}};
    const auto add = [&](const std::vector<report::Row>& rows) {
        results.rows.insert(results.rows.end(), rows.begin(), rows.end());
    };
    const NamedTrees trees(reportedMeshes(options.meshes, options.quick));
    WorkloadCheck check;
    if (wanted("work")) {
        std::cerr << "work ...\n";
        add(workRows(trees.all(), sizes.zachmann, sizes.grazing, options.seed, check));
    }
    if (wanted("unlike") && trees.all().size() > 1) {
        std::cerr << "unlike ...\n";
        add(unlikeRows(trees.all(), sizes.unlike, sizes.repetitions, options.seed, check));
    }
    for (const TreeOf& mesh : trees.all()) {
        std::cerr << mesh.name << " ...\n";
        if (wanted("coherent")) {
            add(coherentRows(mesh, sizes.steps, sizes.repetitions, options.seed, check));
        }
        if (wanted("hot")) {
            add(hotRows(mesh, sizes.hot, sizes.replays, sizes.repetitions, options.seed, check));
        }
    }
    const double wrong = wrongOfExact(results.rows);
    for (const char* scenario : {"coherent, orbit", "coherent, flyby", "hot", "hot, as many shuffled"}) {
        for (const Overall& one : overall(results.rows, scenario)) {
            results.rows.push_back(one.row(scenario));
        }
    }
    const double colliding = check.colliding / std::max(1.0, check.poses);
    results.claims.push_back({"disagreements with FCL beyond the borderline", check.disagreements, false, 0});
    results.claims.push_back({"exact answers that are not certain", check.uncertain, false, 0});
    results.claims.push_back({"wrong answers of exact, with the witness or not", wrong, false, 0});
    results.claims.push_back({"share of colliding poses", colliding, true, 0.1});
    results.claims.push_back({"share of colliding poses", colliding, false, 0.9});
    return results;
}

}  // namespace grapeshot::bench
