#include "tracking_fit.hpp"

#include <algorithm>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include <report/machine.hpp>

#include "tracking_coils.hpp"
#include "tracking_truth.hpp"

namespace grapeshot::bench {

namespace {

constexpr int seedsPerChoice = 6;

struct Choice {
    TrackingBudget budget;
    float spacing;                  ///< tube radii
    std::vector<Tracker> trackers;  ///< one of each seed
    std::vector<double> us, work;
    std::vector<double> coverage;  ///< [seed] sum over the frames

    [[nodiscard]] std::string name() const {
        std::ostringstream text;
        text << budget.work << " units, " << budget.frontCells << " cells, audit " << budget.auditShare << ", spacing "
             << spacing << ", ahead " << budget.lookAhead;
        return text.str();
    }
};

/// One at a time around those that were chosen.
std::vector<Choice> choicesOf(const BallTree& tree, bool quick) {
    constexpr float chosenSpacing = fittingCoil.spacing / fittingCoil.tubeRadius;
    const std::size_t seeds = quick ? 2 : seedsPerChoice;
    std::vector<Choice> choices;
    const auto add = [&](const TrackingBudget& budget, float spacing) {
        choices.push_back(
            {budget, spacing, std::vector<Tracker>(seeds, Tracker(tree)), {}, {}, std::vector<double>(seeds, 0)});
    };
    const TrackingBudget chosen = coilBudget(fittingCoil);
    for (const double share : {0.7, 0.75, 0.8, 0.9, 1.0, 1.2}) {
        add(withWork(chosen, static_cast<std::uint64_t>(share * static_cast<double>(chosen.work))), chosenSpacing);
    }
    for (const float spacing : {0.6F, 0.9F, 1.6F}) {
        add(chosen, spacing);
    }
    for (const std::uint32_t cells : {32U, 128U}) {
        add({chosen.work, cells, chosen.auditShare, chosen.lookAhead}, chosenSpacing);
    }
    for (const float share : {0.05F, 0.25F, 0.5F}) {
        add({chosen.work, chosen.frontCells, share, chosen.lookAhead}, chosenSpacing);
    }
    for (const float steps : {0.0F, 1.0F, 4.0F}) {
        add({chosen.work, chosen.frontCells, chosen.auditShare, steps}, chosenSpacing);
    }
    return choices;
}

}  // namespace

void addFitRows(std::uint64_t seed, bool quick, report::Report& results) {
    struct Size {
        const char* name;
        std::size_t triangles;
        int frames;
    };
    const std::vector<Size> sizes =
        quick ? std::vector<Size>{{"fittingCoil10k", 10'000, 6}}
              : std::vector<Size>{
                    {"fittingCoil10k", 10'000, 40}, {"fittingCoil100k", 100'000, 40}, {"fittingCoil1M", 1'000'000, 30}};
    for (const Size& size : sizes) {
        std::cerr << size.name << " ...\n";
        const int warmUp = quick ? 2 : 20;  // nothing is tracked before the first frame
        TrackingScene scene = coil(size.name, fittingCoil, size.triangles);
        const BallTree tree = buildBallTree(scene.a.view());
        std::vector<Choice> choices = choicesOf(tree, quick);
        Tracker exact(tree);
        TrackResult truth;
        TrackResult result;
        std::vector<double> exactUs;
        TrackingFrame before;
        for (int frame = 0; frame < size.frames; ++frame) {
            const TrackingFrame where = coilAt(scene, fittingCoil, static_cast<float>(frame));
            const float moved = before.a.empty() ? 0 : 1.02F * farthestMove(before.a, where.a);
            before = where;
            SurfaceState state{where.a, {}, Stretch::given(1.02F * measureStretch(tree.surface, where.a)), {}, {}};
            if (frame >= warmUp) {
                TrackSettings settings = settingsOf(scene, coilBudget(fittingCoil), seed);
                settings.mode = TrackMode::exact;
                const double begin = report::threadCpuUs();
                exact.step(state, settings, {}, truth);
                exactUs.push_back(report::threadCpuUs() - begin);
            }
            state.displacement = Displacement::given(moved);
            for (Choice& choice : choices) {
                for (std::size_t i = 0; i < choice.trackers.size(); ++i) {
                    TrackSettings settings = settingsOf(scene, choice.budget, seed + i);
                    settings.spacing = choice.spacing * fittingCoil.tubeRadius;
                    const double begin = report::threadCpuUs();
                    choice.trackers[i].step(state, settings, {.work = choice.budget.work}, result);
                    const double us = report::threadCpuUs() - begin;
                    if (frame >= warmUp) {
                        choice.us.push_back(us);
                        choice.work.push_back(static_cast<double>(result.work));
                        choice.coverage[i] += coverage(truth.contacts, result.contacts, fittingCoil.tubeRadius) /
                                              static_cast<double>(size.frames - warmUp);
                    }
                }
            }
        }
        for (const Choice& choice : choices) {
            report::Row row;
            row.scenario = "fit";
            row.mesh = scene.name;
            row.triangles = scene.a.triangles.size();
            row.method = choice.name();
            row.peer = "exact";
            row.n = choice.us.size();
            row.timeUs = report::quantiles(choice.us);
            row.ratio = report::mean(exactUs) / row.timeUs.mean;
            row.work = {{"mean", report::mean(choice.work)}, {"max", *std::ranges::max_element(choice.work)}};
            row.measured = {{"coverage", report::mean(choice.coverage)},
                            {"coverageOfWorstSeed", *std::ranges::min_element(choice.coverage)}};
            results.rows.push_back(row);
        }
    }
}

}  // namespace grapeshot::bench
