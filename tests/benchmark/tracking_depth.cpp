#include "tracking_depth.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <grapeshot/adb/point_query.hpp>
#include <grapeshot/core/mesh_report.hpp>
#include <grapeshot/scf/depth.hpp>

#include <report/machine.hpp>
#include <support/depth_oracle.hpp>
#include <support/poses.hpp>

#include "meshes.hpp"

namespace grapeshot::bench {

namespace {

constexpr float spacing = 0.05F;      // m, of the sampled contacts
constexpr float stepBefore = 0.004F;  // m, 0.2 % of the size: the step that summits are known from

/// Of the true regions at one depth.
struct DepthTally {
    std::vector<double> coldUs, warmUs, coldWork, warmWork;  ///< per pose
    std::vector<double> errors;                              ///< of the depth, relative; regions that were found
    double regions = 0, lost = 0;
    double crossings = 0, crossingsLost = 0;  ///< no vertex is inside
    double tooDeep = 0;                       ///< deeper than the truth
    double reported = 0;
    int poses = 0;
};

class DepthScene {
  public:
    explicit DepthScene(const scenes::Mesh& mesh)
        : m_boxes(build(mesh.view())),
          m_a(buildBallTree(mesh.view())),
          m_b(buildBallTree(mesh.view())),
          m_tracker(m_a, m_b),
          m_query(m_a, m_b) {}

    [[nodiscard]] std::vector<Pose> poses(int count, double depth, std::uint64_t seed) const {
        return test::grazingPoses(m_boxes, m_boxes, count, -depth, seed);
    }

    /// @param sampled measured from one contact per pair of cells, else from all
    void measure(const Pose& bInA, DepthTally& all, DepthTally& sampled) {
        const std::vector<TrackedContact> cuts = contactsAt(bInA, TrackMode::exact);
        std::vector<TrianglePair> pairs;
        for (const TrackedContact& contact : cuts) {
            pairs.push_back(contact.pair);
        }
        const std::vector<test::TrueRegion> truth = test::trueRegions(m_boxes, m_boxes, bInA, pairs);
        tally(bInA, TrackMode::exact, truth, all);
        tally(bInA, TrackMode::resolution, truth, sampled);
    }

  private:
    [[nodiscard]] std::vector<TrackedContact> contactsAt(const Pose& bInA, TrackMode mode) {
        TrackSettings settings;
        settings.mode = mode;
        settings.spacing = spacing;
        m_tracker.clear();
        std::vector<TrackedContact> contacts = m_tracker.step(rigidState(), rigidState(bInA), settings).contacts;
        std::erase_if(contacts, [](const TrackedContact& contact) { return !contact.overlapping; });
        return contacts;
    }

    void tally(const Pose& bInA, TrackMode mode, const std::vector<test::TrueRegion>& truth, DepthTally& into) {
        const DepthSettings settings{.spacing = mode == TrackMode::exact ? 0 : 2 * spacing};
        const std::vector<TrackedContact> contacts = contactsAt(bInA, mode);
        Pose before = bInA;
        before.translation += stepBefore * bInA.translation.normalized();
        const std::vector<TrackedContact> contactsBefore = contactsAt(before, mode);
        DepthMemory none;
        DepthMemory memory;
        static_cast<void>(m_query.measure(rigidState(), rigidState(before), contactsBefore, {}, settings, memory));
        const double begin = report::threadCpuUs();
        const DepthResult cold = m_query.measure(rigidState(), rigidState(bInA), contacts, {}, settings, none);
        const double middle = report::threadCpuUs();
        const DepthResult warm = m_query.measure(rigidState(), rigidState(bInA), contacts, {}, settings, memory);
        const double end = report::threadCpuUs();
        into.coldUs.push_back(middle - begin);
        into.warmUs.push_back(end - middle);
        into.coldWork.push_back(static_cast<double>(cold.work));
        into.warmWork.push_back(static_cast<double>(warm.work));
        into.reported += static_cast<double>(warm.regions.size());
        ++into.poses;
        for (const test::TrueRegion& region : truth) {
            judge(region, warm, into);
        }
    }

    static void judge(const test::TrueRegion& truth, const DepthResult& result, DepthTally& into) {
        const bool isCrossing = truth.insideA.empty() && truth.insideB.empty();
        bool isFound = false;
        double deepest = 0;
        for (const DepthRegion& region : result.regions) {
            if (region.source == DepthSource::crossing) {
                isFound = isFound || std::ranges::any_of(truth.cuts, [&](const TrianglePair& pair) {
                              return pair.triangleB == region.triangle;
                          });
            } else if (std::ranges::binary_search(
                           region.source == DepthSource::vertexOfA ? truth.insideA : truth.insideB, region.vertex)) {
                isFound = true;
                deepest = std::max(deepest, static_cast<double>(region.depth));
            }
        }
        (isCrossing ? into.crossings : into.regions) += 1;
        (isCrossing ? into.crossingsLost : into.lost) += isFound ? 0 : 1;
        if (!isCrossing && isFound) {
            into.errors.push_back(std::abs(deepest / truth.depth - 1));
            into.tooDeep += deepest > truth.depth * (1 + 1e-5) + 1e-6 ? 1 : 0;
        }
    }

    Tree m_boxes;
    BallTree m_a, m_b;
    Tracker m_tracker;
    DepthQuery m_query;
};

report::Row depthRow(const std::string& mesh, std::size_t triangles, const std::string& method,
                     const DepthTally& tally) {
    report::Row row;
    row.scenario = "depth";
    row.mesh = mesh;
    row.triangles = triangles;
    row.method = method;
    row.peer = "without summits before";
    row.n = static_cast<std::size_t>(tally.poses);
    row.timeUs = report::quantiles(tally.warmUs);
    row.ratio = report::mean(tally.coldUs) / row.timeUs.mean;
    row.work = {{"mean", report::mean(tally.warmWork)}, {"meanCold", report::mean(tally.coldWork)}};
    row.measured = {{"regions", tally.regions},
                    {"lost", tally.lost},
                    {"meanError", report::mean(tally.errors)},
                    {"p99Error", report::quantile(tally.errors, 0.99)},
                    {"tooDeep", tally.tooDeep},
                    {"crossings", tally.crossings},
                    {"crossingsLost", tally.crossingsLost},
                    {"reportedPerPose", tally.reported / tally.poses}};
    return row;
}

void addTo(DepthTally& sum, const DepthTally& one) {
    sum.errors.insert(sum.errors.end(), one.errors.begin(), one.errors.end());
    sum.regions += one.regions;
    sum.lost += one.lost;
    sum.crossings += one.crossings;
    sum.crossingsLost += one.crossingsLost;
    sum.tooDeep += one.tooDeep;
}

}  // namespace

void addDepthRows(std::uint64_t seed, bool quick, int poses, report::Report& results) {
    constexpr double depths[] = {0.02, 0.05, 0.1};
    DepthTally sums[3][2];
    for (const NamedMesh& mesh : generatedMeshes(quick)) {
        if (mesh.mesh.triangles.size() > 200'000 || !inspect(mesh.mesh.view()).closed) {
            continue;
        }
        DepthScene scene(mesh.mesh);
        for (std::size_t d = 0; d < 3; ++d) {
            DepthTally tallies[2];
            for (const Pose& bInA : scene.poses(poses, depths[d], seed + d)) {
                scene.measure(bInA, tallies[0], tallies[1]);
            }
            const std::string percent = std::to_string(std::lround(100 * depths[d])) + " % deep, ";
            for (int sampled = 0; sampled < 2; ++sampled) {
                results.rows.push_back(depthRow(mesh.name, mesh.mesh.triangles.size(),
                                                percent + (sampled == 1 ? "sampled contacts" : "all contacts"),
                                                tallies[sampled]));
                addTo(sums[d][sampled], tallies[sampled]);
            }
        }
    }
    for (std::size_t d = 0; d < 3; ++d) {
        for (int sampled = 0; sampled < 2; ++sampled) {
            const DepthTally& sum = sums[d][sampled];
            const std::string name = std::to_string(std::lround(100 * depths[d])) + " % deep, " +
                                     (sampled == 1 ? "sampled contacts" : "all contacts");
            if (sampled == 0) {
                results.claims.push_back({name + ": share of the regions lost", sum.lost / sum.regions, false, 0.01});
            }
            results.claims.push_back({name + ": deeper than the truth", sum.tooDeep, false, 0});
        }
    }
}

}  // namespace grapeshot::bench
