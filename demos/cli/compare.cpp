// `grapeshot compare A B`: the exact query on random poses: how often they collide, what it costs, and whether its two
// ways to the answer agree.
#include <CLI/CLI.hpp>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <import/mesh_import.hpp>
#include <memory>

#include <grapeshot/adb/query.hpp>
#include <grapeshot/core/random.hpp>
#include <report/machine.hpp>
#include <report/report.hpp>
#include <report/text_file.hpp>

#include "commands.hpp"

namespace grapeshot::cli {
namespace {

struct CompareOptions {
    std::string fileA;
    std::string fileB;
    std::size_t poses = 1000;
    std::uint64_t seed = 1;
    double distance = 0.01;  ///< of contacts, relative to the mean diagonal of the two boxes
    std::string jsonFile;
};

struct NamedTree {
    std::string name;
    Tree tree;
};

NamedTree load(const std::string& file) {
    return {std::filesystem::path(file).filename().string(), build(import::importMesh(file).view())};
}

float diagonal(const Tree& tree) {
    return (tree.upper - tree.lower).norm();
}

/// Uniform rotation (Shoemake, Uniform Random Rotations, Graphics Gems III, 1992), B's middle anywhere in A's box
/// inflated by half of B's diagonal. Draws 0..5 of the pose's key.
Pose randomPose(const Tree& a, const Tree& b, const RandomKey& key) {
    const auto unit = [&](std::uint32_t draw) { return randomUnit(key, draw); };
    const float turn = 2 * static_cast<float>(EIGEN_PI);
    const float s = std::sqrt(1 - unit(0));
    const float r = std::sqrt(unit(0));
    const Eigen::Quaternionf q(r * std::cos(turn * unit(2)), s * std::sin(turn * unit(1)), s * std::cos(turn * unit(1)),
                               r * std::sin(turn * unit(2)));
    const Eigen::Vector3f draw(unit(3), unit(4), unit(5));
    const Eigen::Vector3f margin = Eigen::Vector3f::Constant(diagonal(b) / 2);
    const Eigen::Vector3f middle = a.lower - margin + draw.cwiseProduct(a.upper - a.lower + 2 * margin);
    Pose pose;
    pose.rotation = q.normalized().toRotationMatrix();
    pose.translation = middle - pose.rotation * ((b.lower + b.upper) / 2);
    return pose;
}

/// One way of asking, over all poses.
struct Series {
    std::vector<double> timeUs;
    double work = 0;
    double colliding = 0;
    double pairs = 0;
    double mostPairs = 0;

    [[nodiscard]] report::Row row(const std::string& scenario, const NamedTree& a, const NamedTree& b) const {
        report::Row row;
        row.scenario = scenario;
        row.mesh = a.name + " / " + b.name;
        row.triangles = a.tree.triangles.size() + b.tree.triangles.size();
        row.method = "exact";
        row.n = timeUs.size();
        row.colliding = colliding;
        row.timeUs = report::quantiles(timeUs);
        const auto n = static_cast<double>(timeUs.size());
        row.work = {{"units/pose", work / n}};
        if (mostPairs > 0) {
            row.work.emplace_back("pairs/pose", pairs / n);
            row.work.emplace_back("most pairs", mostPairs);
        }
        return row;
    }
};

report::Report compareTrees(const NamedTree& a, const NamedTree& b, const CompareOptions& options) {
    Series decide;
    Series contacts;
    double contradictions = 0;
    Query query(a.tree, b.tree);
    Contacts found;
    const auto distance = static_cast<float>(options.distance) * (diagonal(a.tree) + diagonal(b.tree)) / 2;
    for (std::size_t i = 0; i < options.poses; ++i) {
        const Pose pose = randomPose(a.tree, b.tree, {.seed = options.seed, .pair = i});
        const double start = report::wallUs();
        const Decision decision = query.decide(pose, DecideSettings::exact());
        const double middle = report::wallUs();
        query.contacts(pose, {.maxDistance = distance}, {}, found);
        const double end = report::wallUs();

        decide.timeUs.push_back(middle - start);
        decide.work += static_cast<double>(decision.work);
        decide.colliding += decision.collides ? 1 : 0;
        contacts.timeUs.push_back(end - middle);
        contacts.work += static_cast<double>(found.work);
        const bool overlapping =
            std::any_of(found.pairs.begin(), found.pairs.end(), [](const TriangleContact& c) { return c.overlapping; });
        contacts.colliding += overlapping ? 1 : 0;
        contacts.pairs += static_cast<double>(found.pairs.size());
        contacts.mostPairs = std::max(contacts.mostPairs, static_cast<double>(found.pairs.size()));
        contradictions += !decision.certain || !found.certain || decision.collides != overlapping ? 1 : 0;
    }
    report::Report result;
    result.suite = "compare";
    result.seed = options.seed;
    result.rows = {decide.row("decide", a, b),
                   contacts.row("contacts within " + std::to_string(distance) + " m", a, b)};
    result.claims = {{"decide and contacts contradict each other", contradictions, false, 0}};
    return result;
}

ExitCode compareFiles(const CompareOptions& options) {
    const NamedTree a = load(options.fileA);
    const NamedTree b = load(options.fileB);
    const report::Report result = compareTrees(a, b, options);
    std::fputs(table(result).c_str(), stdout);
    if (!options.jsonFile.empty()) {
        report::writeText(options.jsonFile, json(result));
    }
    return result.holds() ? done : claimFailed;
}

}  // namespace

void addCompare(CLI::App& tool, std::function<ExitCode()>& run) {
    auto* command = tool.add_subcommand("compare", "The exact query between two meshes on random poses: counts, cost");
    auto options = std::make_shared<CompareOptions>();
    command->add_option("A", options->fileA, "mesh file")->required();
    command->add_option("B", options->fileB, "mesh file")->required();
    command->add_option("--poses", options->poses, "how many")->check(CLI::Range(1, 10'000'000))->capture_default_str();
    command->add_option("--seed", options->seed, "of the poses")->capture_default_str();
    command->add_option("--distance", options->distance, "reach of contacts / mean box diagonal")
        ->check(CLI::Range(0.0, 1.0))
        ->capture_default_str();
    command->add_option("--json", options->jsonFile, "also write the rows here");
    command->callback([options, &run] { run = [options] { return compareFiles(*options); }; });
}

}  // namespace grapeshot::cli
