#include "comparison.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace grapeshot::bench {

namespace {

/// Answers of one method, beside the truth.
void addAnswers(const PosedPair& where, const Peer& method, report::Row& row) {
    const std::vector<double> none(where.set.distances.size(), 0);
    std::vector<double> poses = none;
    std::vector<double> colliding = none;
    std::vector<double> misses = none;
    std::vector<double> alarms = none;
    Errors errors;
    std::vector<double> work;
    for (std::size_t i = 0; i < where.set.poses.size(); ++i) {
        const Answer answer = method.decide(where.set.poses[i]);
        const bool truth = where.truth.collides[i] != 0;
        const auto distance = static_cast<std::size_t>(where.set.distanceIndex[i]);
        errors.add(answer.collides, truth);
        poses[distance] += 1;
        colliding[distance] += truth ? 1 : 0;
        misses[distance] += truth && !answer.collides ? 1 : 0;
        alarms[distance] += answer.collides && !truth ? 1 : 0;
        work.push_back(static_cast<double>(answer.work));
    }
    row.falseNegatives = errors.falseNegatives;
    row.falsePositives = errors.falsePositives;
    row.measured = {{"errorPct", errors.percentOf(row.n)}};
    row.curves = {{"distance", where.set.distances},
                  {"poses", poses},
                  {"colliding", colliding},
                  {"falseNegatives", misses},
                  {"falsePositives", alarms}};
    addWork(work, row);
}

}  // namespace

void addRatios(const std::vector<Times>& times, std::size_t method, std::size_t peer, report::Row& row) {
    row.timeUs.mean = report::median(times[method]);
    const std::vector<double> toExact = ratios(times[method], times[0]);
    const std::vector<double> toPeer = ratios(times[method], times[peer]);
    row.ratio = report::median(toPeer);
    row.measured.insert(row.measured.end(), {{"ratioToExact", report::median(toExact)},
                                             {"ratioToExactSpread", report::spread(toExact)},
                                             {"ratioSpread", report::spread(toPeer)}});
}

void addWork(const std::vector<double>& work, report::Row& row) {
    const report::Quantiles units = report::quantiles(work);
    if (units.max > 0) {
        row.work = {{"workMean", units.mean}, {"workP50", units.p50}, {"workP99", units.p99}, {"workMax", units.max}};
    }
}

std::vector<report::Row> compare(const PosedPair& where, const std::vector<Peer>& methods, int repetitions,
                                 std::size_t peer) {
    const std::vector<Pose>& poses = where.set.poses;
    std::vector<Contender> contenders;
    for (const Peer& method : methods) {
        contenders.push_back(contender(method, poses));
    }
    const std::vector<Times> times = interleaved(contenders, poses.size(), repetitions);
    std::vector<report::Row> rows;
    for (std::size_t i = 0; i < methods.size(); ++i) {
        report::Row& row = rows.emplace_back();
        row.scenario = where.scenario;
        row.mesh = where.mesh;
        row.triangles = where.triangles;
        row.method = methods[i].name;
        row.peer = methods[peer].name;
        row.n = poses.size();
        row.colliding = static_cast<double>(where.truth.colliding);
        addAnswers(where, methods[i], row);
        row.timeUs = report::quantiles(leastUs(contenders[i], poses.size(), repetitions));
        addRatios(times, i, peer, row);
    }
    return rows;
}

double measured(const report::Row& row, const std::string& name) {
    const auto found = std::ranges::find(row.measured, name, [](const auto& entry) { return entry.first; });
    return found != row.measured.end() ? found->second : report::notApplicable;
}

std::vector<Overall> overall(const std::vector<report::Row>& rows, const std::string& scenario) {
    std::vector<Overall> all;
    for (const report::Row& row : rows) {
        if (row.scenario != scenario) {
            continue;
        }
        auto found = std::ranges::find(all, row.method, &Overall::method);
        if (found == all.end()) {
            found = all.insert(all.end(), Overall{row.method});
        }
        ++found->meshes;
        found->poses += row.n;
        found->ratioToFcl += std::log(row.ratio);
        found->ratioToExact += std::log(measured(row, "ratioToExact"));
        found->errorPercent += measured(row, "errorPct");
        found->worstErrorPercent = std::max(found->worstErrorPercent, measured(row, "errorPct"));
    }
    for (Overall& one : all) {
        const auto meshes = static_cast<double>(one.meshes);
        one.ratioToFcl = std::exp(one.ratioToFcl / meshes);
        one.ratioToExact = std::exp(one.ratioToExact / meshes);
        one.errorPercent /= meshes;
    }
    return all;
}

const Overall& of(const std::vector<Overall>& all, const std::string& method) {
    const auto found = std::ranges::find(all, method, &Overall::method);
    if (found == all.end()) {
        throw std::logic_error("no rows of '" + method + "'");
    }
    return *found;
}

report::Row Overall::row(const std::string& scenario) const {
    report::Row row;
    row.scenario = scenario;
    row.mesh = "mean of " + std::to_string(meshes);
    row.method = method;
    row.peer = "FCL OBBRSS";
    row.n = poses;
    row.ratio = ratioToFcl;
    row.measured = {{"errorPct", errorPercent}, {"worstErrorPct", worstErrorPercent}, {"ratioToExact", ratioToExact}};
    return row;
}

}  // namespace grapeshot::bench
