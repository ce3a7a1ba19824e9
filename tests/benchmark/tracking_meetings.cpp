#include "tracking_meetings.hpp"

#include <vector>

#include <grapeshot/adb/query.hpp>
#include <grapeshot/scf/tracker.hpp>

#include <report/machine.hpp>
#include <support/poses.hpp>

#include "box_refit.hpp"
#include "tracking_truth.hpp"

namespace grapeshot::bench {

namespace {

constexpr int stepsPerMeeting = 4;
constexpr float approach = 0.008F;  // m a step, 0.4 % of the size

report::Row rowOf(const MeetingSpec& spec, const TrackingScene& scene, const char* method,
                  const std::vector<double>& us) {
    report::Row row;
    row.scenario = "meetings";
    row.mesh = spec.name;
    row.triangles = scene.a.triangles.size() + scene.b.triangles.size();
    row.method = method;
    row.peer = "boxes refitted";
    row.n = us.size();
    row.timeUs = report::quantiles(us);
    return row;
}

}  // namespace

MeetingResult addMeetingRows(const MeetingSpec& spec, std::uint64_t seed, report::Report& results) {
    const TrackingScene scene = twoBodies(spec.name, spec.frequency, static_cast<std::uint32_t>(seed % 100'019));
    const BallTree a = buildBallTree(scene.a.view());
    const BallTree b = buildBallTree(scene.b.view());
    Tree boxesA = build(scene.a.view());
    Tree boxesB = build(scene.b.view());
    Query query(boxesA, boxesB);
    const TrackSettings settings = settingsOf(scene, spec.budget, seed);
    TrackSettings exactly = settings;
    exactly.mode = TrackMode::exact;
    test::Random random(seed);
    Tracker exact(a, b);
    Tracker tracker(a, b);
    TrackResult truth;
    TrackResult result;
    Contacts contacts;
    std::vector<double> boxUs, exactUs, budgetUs;
    double regions = 0, found = 0;  // new in their step
    double allRegions = 0, allFound = 0;
    double certain = 0;
    double mismatches = 0;
    tracker.step({}, {}, settings, {.work = spec.budget.work}, result);  // the first cuts the surfaces, O(n)
    for (int meeting = 0; meeting < spec.meetings; ++meeting) {
        const Eigen::Matrix3f turnA = random.rotation();
        const Eigen::Matrix3f turnB = random.rotation();
        const auto at = [&](float gap, int step) {
            return twoBodiesTurned(scene, turnA, turnB, gap, 0.15F * static_cast<float>(step + 7 * meeting));
        };
        const auto statesOf = [&](const TrackingFrame& where) {
            return std::pair{SurfaceState{where.a, {}, Stretch::given(1.02F * measureStretch(a.surface, where.a)), {}},
                             SurfaceState{where.b, {}, Stretch::given(1.02F * measureStretch(b.surface, where.b)), {}}};
        };
        float touching = 0.4F;
        float apart = 2.4F;
        while (apart - touching > 0.25F * approach) {
            const float gap = 0.5F * (touching + apart);
            const TrackingFrame where = at(gap, 2);
            const auto [stateA, stateB] = statesOf(where);
            exact.step(stateA, stateB, exactly, {.work = 4'000}, truth);
            (truth.certain && truth.contacts.empty() ? apart : touching) = gap;
        }
        tracker.clear();
        RegionHistory history(scene.spacing);
        for (int step = 0; step < stepsPerMeeting; ++step) {
            const TrackingFrame where = at(apart - approach * (static_cast<float>(step) - 1.5F), step);
            const auto [stateA, stateB] = statesOf(where);
            const double begin = report::threadCpuUs();
            refitBoxes(boxesA, where.a);
            refitBoxes(boxesB, where.b);
            query.contacts({}, {.maxDistance = scene.maxDistance}, {}, contacts);
            const double boxesEnd = report::threadCpuUs();
            exact.step(stateA, stateB, exactly, {}, truth);
            const double exactEnd = report::threadCpuUs();
            tracker.step(stateA, stateB, settings, {.work = spec.budget.work}, result);
            const double end = report::threadCpuUs();
            boxUs.push_back(boxesEnd - begin);
            exactUs.push_back(exactEnd - boxesEnd);
            budgetUs.push_back(end - exactEnd);
            certain += result.certain ? 1 : 0;
            mismatches += truth.contacts.size() == contacts.pairs.size() ? 0 : 1;
            history.advance(truth.contacts, a.surface, b.surface);
            const std::vector<bool> isFound = history.found(result.contacts);
            allRegions += static_cast<double>(isFound.size());
            for (std::size_t i = 0; i < isFound.size(); ++i) {
                regions += history.ages()[i] == 1 ? 1 : 0;
                found += history.ages()[i] == 1 && isFound[i] ? 1 : 0;
                allFound += isFound[i] ? 1 : 0;
            }
        }
    }
    report::Row boxes = rowOf(spec, scene, "boxes refitted", boxUs);
    report::Row exactRow = rowOf(spec, scene, "exact, bound given", exactUs);
    report::Row budget = rowOf(spec, scene, "budget, bound given", budgetUs);
    exactRow.measured = {{"mismatches", mismatches}};
    budget.measured = {{"recall1", found / regions},
                       {"regions1", regions},
                       {"recallAll", allFound / allRegions},
                       {"regionsAll", allRegions},
                       {"certain", certain / static_cast<double>(budgetUs.size())}};
    for (report::Row* row : {&boxes, &exactRow, &budget}) {
        row->ratio = boxes.timeUs.mean / row->timeUs.mean;
        results.rows.push_back(*row);
    }
    return {mismatches, found / regions, allFound / allRegions, budget.ratio};
}

}  // namespace grapeshot::bench
