// grapeshot_bench: every number that the project claims, measured beside a peer in the same run.
#include <exception>
#include <fstream>
#include <iostream>
#include <map>
#include <stdexcept>

#include <report/report.hpp>
#include "anytime_suite.hpp"
#include "contacts_suite.hpp"
#include "continuous_suite.hpp"
#include "decide_suite.hpp"
#include "fit_suite.hpp"
#include "guarantee_suite.hpp"
#include "options.hpp"
#include "paper_suite.hpp"
#include "scene_suite.hpp"
#include "soft_suite.hpp"
#include "stochastic_suite.hpp"
#include "tracking_suite.hpp"
#include "trees_suite.hpp"
#include "workloads_suite.hpp"

namespace {

using Suite = grapeshot::report::Report (*)(const grapeshot::bench::Options&);

/// One of those that the options know.
Suite suiteNamed(const std::string& suite) {
    using namespace grapeshot::bench;
    static const std::map<std::string, Suite> suites{
        {"anytime", runAnytimeSuite},       {"contacts", runContactsSuite}, {"continuous", runContinuousSuite},
        {"decide", runDecideSuite},         {"fit", runFitSuite},           {"guarantee", runGuaranteeSuite},
        {"paper", runPaperSuite},           {"scene", runSceneSuite},       {"soft", runSoftSuite},
        {"stochastic", runStochasticSuite}, {"tracking", runTrackingSuite}, {"trees", runTreesSuite},
        {"workloads", runWorkloadsSuite}};
    return suites.at(suite);
}

enum ExitCode { allHold = 0, claimFailed = 1, badUse = 2 };

int run(const grapeshot::bench::Options& options) {
    using namespace grapeshot::bench;
    namespace report = grapeshot::report;
    if (options.instructionSet) {
        const grapeshot::InstructionSet used = grapeshot::limitInstructionSet(*options.instructionSet);
        if (used != *options.instructionSet) {
            std::cerr << "grapeshot_bench: this machine has no " << name(*options.instructionSet) << "\n";
            return badUse;
        }
    }
    const report::Report results = suiteNamed(options.suite)(options);
    std::cout << report::table(results);
    if (!options.jsonFile.empty()) {
        std::ofstream file(options.jsonFile);
        file << report::json(results);
        file.close();
        if (!file) {
            std::cerr << "grapeshot_bench: cannot write '" << options.jsonFile << "'\n";
            return badUse;
        }
    }
    return results.holds() ? allHold : claimFailed;
}

}  // namespace

int main(int argumentCount, char** arguments) {
    try {
        const grapeshot::bench::Options options = grapeshot::bench::parse(argumentCount, arguments);
        if (options.help) {
            std::cout << grapeshot::bench::usage();
            return allHold;
        }
        return run(options);
    } catch (const std::invalid_argument& error) {
        std::cerr << "grapeshot_bench: " << error.what() << "\n\n" << grapeshot::bench::usage();
        return badUse;
    } catch (const std::exception& error) {
        std::cerr << "grapeshot_bench: " << error.what() << "\n";
        return badUse;
    }
}
