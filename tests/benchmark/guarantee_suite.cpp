#include "guarantee_suite.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>

#include <grapeshot/adb/certificate.hpp>
#include <grapeshot/core/rate_bound.hpp>
#include <support/poses.hpp>

#include <report/machine.hpp>
#include "comparison.hpp"
#include "guarantee_audit.hpp"
#include "guarantee_meshes.hpp"

namespace grapeshot::bench {

namespace {

constexpr int promiseDistances = 12;
constexpr double missLimit = 0.01;  // what is promised
constexpr double falseAlarmLimit = 0.05;
constexpr double confidence = 0.95;
/// A promise counts as broken if the true rate is above it with this confidence.
constexpr double brokenAt = 0.99;

/// On shuffled poses a witness is of no use.
DecideSettings withoutWitness(DecideSettings settings) {
    settings.tryWitness = false;
    return settings;
}

struct Answers {
    std::size_t colliding = 0, misses = 0, falseAlarms = 0, certain = 0;
    std::vector<double> work, exactWork;
};

Answers answer(const Tree& tree, const DecideSettings& settings, const std::vector<Pose>& poses) {
    Answers answers;
    Query exact(tree, tree);
    Query estimate(tree, tree);
    for (const Pose& pose : poses) {
        const Decision truth = exact.decide(pose, withoutWitness(DecideSettings::exact()));
        const Decision decision = estimate.decide(pose, settings);
        answers.colliding += truth.collides ? 1U : 0U;
        answers.misses += truth.collides && !decision.collides ? 1U : 0U;
        answers.falseAlarms += !truth.collides && decision.collides ? 1U : 0U;
        answers.certain += decision.certain ? 1U : 0U;
        answers.work.push_back(static_cast<double>(decision.work));
        answers.exactWork.push_back(static_cast<double>(truth.work));
    }
    return answers;
}

struct Timing {
    std::vector<double> us, exactUs, ratios;  ///< mean per query, one value per repetition
};

/// Both on the same chunk of poses, one right after the other and taking turns in going first.
Timing measure(const Tree& tree, const DecideSettings& settings, const std::vector<Pose>& poses, int repetitions) {
    constexpr std::size_t chunk = 200;
    const DecideSettings exactSettings = withoutWitness(DecideSettings::exact());
    Timing timing;
    std::size_t collisions = 0;
    Query exact(tree, tree);
    Query estimate(tree, tree);
    for (int repetition = 0; repetition < repetitions; ++repetition) {
        double exactUs = 0;
        double us = 0;
        for (std::size_t begin = 0; begin < poses.size(); begin += chunk) {
            const std::size_t end = std::min(begin + chunk, poses.size());
            const auto run = [&](Query& query, const DecideSettings& asked, double& sum) {
                const double start = report::threadCpuUs();
                for (std::size_t i = begin; i < end; ++i) {
                    collisions += query.decide(poses[i], asked).collides ? 1U : 0U;
                }
                sum += report::threadCpuUs() - start;
            };
            const bool exactFirst = (begin / chunk + static_cast<std::size_t>(repetition)) % 2 == 0;
            if (exactFirst) {
                run(exact, exactSettings, exactUs);
            }
            run(estimate, settings, us);
            if (!exactFirst) {
                run(exact, exactSettings, exactUs);
            }
        }
        timing.us.push_back(us / static_cast<double>(poses.size()));
        timing.exactUs.push_back(exactUs / static_cast<double>(poses.size()));
        timing.ratios.push_back(exactUs / us);
    }
    // The answers must be used, or the compiler may leave the questions out.
    volatile std::size_t sink = collisions;
    static_cast<void>(sink);
    return timing;
}

report::Row runMesh(const NamedMesh& named, const Options& options, int testPoses, int repetitions,
                    Certificate& certificate) {
    const Tree tree = build(named.mesh.view());
    CertificationSettings promise;
    promise.missLimit = missLimit;
    promise.falseAlarmLimit = falseAlarmLimit;
    promise.confidence = confidence;
    promise.seed = options.seed;
    const double start = report::threadCpuUs();
    certificate = calibrate(tree, tree, promise);
    const double certifiedIn = report::threadCpuUs() - start;

    const DecideSettings settings = withoutWitness(certificate.settings);
    // By the tests' generator, not the library's: the distribution is what its name says.
    const std::vector<Pose> poses =
        test::zachmannPoses(tree, tree, promiseDistances, (testPoses + promiseDistances - 1) / promiseDistances,
                            options.seed + 1)
            .poses;
    const Answers answers = answer(tree, settings, poses);
    const Timing timing = measure(tree, settings, poses, repetitions);

    const std::size_t clear = poses.size() - answers.colliding;
    report::Row row;
    row.scenario = "certificate";
    row.mesh = named.name;
    row.triangles = named.mesh.triangles.size();
    row.method = certificate.certified ? "certified" : "refused";
    row.peer = "exact";
    row.n = poses.size();
    row.falseNegatives = static_cast<double>(answers.misses);
    row.falsePositives = static_cast<double>(answers.falseAlarms);
    row.colliding = static_cast<double>(answers.colliding);
    row.timeUs.mean = report::median(timing.us);
    row.ratio = report::median(timing.ratios);
    row.work = {{"workMean", report::quantiles(answers.work).mean},
                {"exactWorkMean", report::quantiles(answers.exactWork).mean}};
    row.measured = {{"exactMeanUs", report::median(timing.exactUs)},
                    {"ratioSpread", report::spread(timing.ratios)},
                    {"certain", static_cast<double>(answers.certain)},
                    {"missLower99", lowerRate(answers.misses, answers.colliding, brokenAt)},
                    {"falseAlarmLower99", lowerRate(answers.falseAlarms, clear, brokenAt)},
                    {"acceptAt", static_cast<double>(settings.acceptAt)},
                    {"rejectAt", static_cast<double>(settings.rejectAt)},
                    {"calibrationColliding", static_cast<double>(certificate.colliding)},
                    {"calibrationMisses", static_cast<double>(certificate.misses)},
                    {"calibrationClear", static_cast<double>(certificate.clear)},
                    {"calibrationFalseAlarms", static_cast<double>(certificate.falseAlarms)},
                    {"certifiedInMs", certifiedIn * 1e-3}};
    return row;
}

void certify(const Options& options, const std::vector<NamedMesh>& meshes, report::Report& results) {
    const int testPoses = options.poses.value_or(options.quick ? 3'000 : 24'000);
    const int repetitions = options.repetitions.value_or(options.quick ? 1 : 7);
    double missLower = 0;
    double falseAlarmLower = 0;
    std::vector<double> ratios;
    double certified = 0;
    for (const NamedMesh& mesh : meshes) {
        std::cerr << mesh.name << " ...\n";
        Certificate certificate;
        const report::Row row = runMesh(mesh, options, testPoses, repetitions, certificate);
        results.rows.push_back(row);
        if (!certificate.certified) {
            std::cerr << mesh.name << ": no certificate: " << certificate.reason << "\n";
        }
        certified += certificate.certified ? 1 : 0;
        missLower = std::max(missLower, measured(row, "missLower99"));
        falseAlarmLower = std::max(falseAlarmLower, measured(row, "falseAlarmLower99"));
        ratios.push_back(row.ratio);
    }
    const auto count = static_cast<double>(meshes.size());
    results.claims.push_back({"meshes with a certificate", certified, true, options.meshes.empty() ? count : 0});
    results.claims.push_back({"largest lower 99 % limit of a mesh's misses / colliding", missLower, false, missLimit});
    results.claims.push_back(
        {"largest lower 99 % limit of a mesh's false alarms / clear", falseAlarmLower, false, falseAlarmLimit});
    if (!options.quick) {
        // A mesh that was refused counts: it is answered exactly, at a ratio of one.
        results.claims.push_back(
            {"exact time / certified, geometric mean over the meshes", report::geometricMean(ratios), true, 4});
    }
}

}  // namespace

report::Report runGuaranteeSuite(const Options& options) {
    report::Report results{
        .suite = "guarantee", .seed = options.seed, .quick = options.quick, .rows = {}, .claims = {}};
    std::vector<NamedMesh> meshes;
    for (const std::string& file : options.meshes) {
        meshes.push_back(fileMesh(file));
    }
    if (meshes.empty()) {
        meshes = guaranteeMeshes(options.quick);
    }
    const auto wanted = [&options](const char* scenario) {
        return options.scenarios.empty() ||
               std::find(options.scenarios.begin(), options.scenarios.end(), scenario) != options.scenarios.end();
    };
    if (wanted("certificate")) {
        certify(options, meshes, results);
    }
    for (const Motion motion : {Motion::resting, Motion::grazing}) {
        if (wanted(name(motion))) {
            std::cerr << "audit, " << name(motion) << " ...\n";
            auditRuns(motion, options, meshes, results);
        }
    }
    return results;
}

}  // namespace grapeshot::bench
