#include "tracking_front.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include <grapeshot/scf/tracker.hpp>

#include <report/machine.hpp>

#include "tracking_coils.hpp"
#include "tracking_scenes.hpp"

namespace grapeshot::bench {

namespace {

constexpr int countedSteps = 20;
constexpr int warmUpSteps = 6;

struct FrontScene {
    TrackingScene scene;
    TrackingBudget budget;
    float begin;  ///< frame
    std::function<TrackingFrame(const TrackingScene&, float frame)> at;
};

struct FrontContender {
    const char* name;
    TrackMode mode;
    std::uint64_t work;
    Displacement::Source source;
    Tracker tracker;
    std::vector<double> us;
    double units = 0, kept = 0, opened = 0, certain = 0, contacts = 0;
    double bound = 0;  ///< of the last step
};

/// Ratios of the least sums: anew / kept, by mode.
double timesFaster(const std::vector<FrontContender>& contenders, std::size_t mode) {
    return report::mean(contenders[3 * mode].us) / report::mean(contenders[3 * mode + 1].us);
}

std::vector<FrontContender> runFront(const FrontScene& spec, float speed, std::uint64_t seed, int steps) {
    const bool self = spec.scene.isSelf();
    const BallTree a = buildBallTree(spec.scene.a.view());
    const BallTree b = self ? BallTree{} : buildBallTree(spec.scene.b.view());
    const Tracker fresh = self ? Tracker(a) : Tracker(a, b);
    std::vector<FrontContender> contenders;
    for (const auto& [mode, work] :
         {std::pair{TrackMode::exact, unlimited}, std::pair{TrackMode::resolution, unlimited},
          std::pair{TrackMode::budget, spec.budget.work}}) {
        contenders.push_back({"laid anew", mode, work, Displacement::Source::unknown, fresh, {}});
        contenders.push_back({"kept, displacement given", mode, work, Displacement::Source::given, fresh, {}});
        contenders.push_back({"kept, displacement measured", mode, work, Displacement::Source::measured, fresh, {}});
    }
    TrackingFrame before;
    TrackResult result;
    for (int step = -warmUpSteps; step < steps; ++step) {
        const TrackingFrame where = spec.at(spec.scene, spec.begin + speed * static_cast<float>(step));
        const auto stateOf = [&](const Surface& surface, const std::vector<Eigen::Vector3f>& last,
                                 const std::vector<Eigen::Vector3f>& now, Displacement::Source source) {
            return SurfaceState{now,
                                {},
                                Stretch::given(1.02F * measureStretch(surface, now)),
                                {},
                                {source, 1.02F * farthestMove(last, now)}};
        };
        for (FrontContender& one : contenders) {
            TrackSettings settings = settingsOf(spec.scene, spec.budget, seed);
            settings.lookAhead = 0;
            settings.mode = one.mode;
            const SurfaceState stateA = stateOf(a.surface, before.a, where.a, one.source);
            const SurfaceState stateB = self ? SurfaceState{} : stateOf(b.surface, before.b, where.b, one.source);
            const double begin = report::threadCpuUs();
            if (self) {
                one.tracker.step(stateA, settings, {.work = one.work}, result);
            } else {
                one.tracker.step(stateA, stateB, settings, {.work = one.work}, result);
            }
            const double us = report::threadCpuUs() - begin;
            if (step < 0) {
                continue;
            }
            one.us.push_back(us);
            one.units += static_cast<double>(result.work) / steps;
            one.kept += static_cast<double>(result.frontKept) / steps;
            one.opened += static_cast<double>(result.frontOpened) / steps;
            one.certain += result.certain ? 1.0 / steps : 0;
            one.contacts += static_cast<double>(result.contacts.size()) / steps;
            one.bound = result.miss.missedBound;
        }
        before = where;
    }
    return contenders;
}

}  // namespace

void addFrontRows(std::uint64_t seed, bool quick, report::Report& results) {
    const auto bodiesAt = [](const TrackingScene& scene, float frame) { return twoBodiesAt(scene, 0.08F, frame, 60); };
    const auto coilFrame = [](const TrackingScene& scene, float frame) { return coilAt(scene, reportedCoil, frame); };
    const std::vector<FrontScene> scenes =
        quick
            ? std::vector<FrontScene>{{coil("coil10k", reportedCoil, 10'000), coilBudget(reportedCoil), 20, coilFrame}}
            : std::vector<FrontScene>{
                  {twoBodies("2x100k", 70, static_cast<std::uint32_t>(seed % 100'003)), bodiesBudget, 30, bodiesAt},
                  {coil("coil100k", reportedCoil, 100'000), coilBudget(reportedCoil), 20, coilFrame}};
    for (const FrontScene& spec : scenes) {
        for (const float speed : {1.0F, 0.1F, 0.01F, 0.0F}) {
            const std::vector<FrontContender> contenders = runFront(spec, speed, seed, quick ? 4 : countedSteps);
            std::ostringstream name;
            name << spec.scene.name << (speed > 0 ? ", speed " : ", at rest");
            if (speed > 0) {
                name << speed;
            }
            for (std::size_t i = 0; i < contenders.size(); ++i) {
                const FrontContender& one = contenders[i];
                const char* const mode[] = {"exact", "resolution", "budget"};
                report::Row row;
                row.scenario = "front";
                row.mesh = name.str();
                row.triangles = spec.scene.a.triangles.size() + spec.scene.b.triangles.size();
                row.method = std::string(mode[i / 3]) + ", " + one.name;
                row.peer = std::string(mode[i / 3]) + ", laid anew";
                row.n = one.us.size();
                row.timeUs = report::quantiles(one.us);
                row.ratio = report::mean(contenders[i - i % 3].us) / row.timeUs.mean;
                row.work = {{"mean", one.units}};
                row.measured = {{"kept", one.kept},
                                {"opened", one.opened},
                                {"certain", one.certain},
                                {"contacts", one.contacts},
                                {"bound", one.bound}};
                results.rows.push_back(row);
            }
            results.claims.push_back({name.str() + ": contacts a step, exact, that the kept front adds or loses",
                                      std::max(std::abs(contenders[1].contacts - contenders[0].contacts),
                                               std::abs(contenders[2].contacts - contenders[0].contacts)),
                                      false, 0});
            if (speed == 0) {
                results.claims.push_back({name.str() + ": units, resolution, laid anew / kept",
                                          contenders[3].units / contenders[4].units, true, 5});
                if (!quick) {
                    results.claims.push_back(
                        {name.str() + ": time, resolution, laid anew / kept", timesFaster(contenders, 1), true, 4});
                }
            }
        }
    }
}

}  // namespace grapeshot::bench
