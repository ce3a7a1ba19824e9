#include "forecasts.hpp"

#include <algorithm>

#include "interleave.hpp"
#include "truncated.hpp"

namespace grapeshot::bench {

namespace {

double collisionProbability(const Decision& decision) {
    return static_cast<double>(decision.collides ? decision.probability : 1 - decision.probability);
}

bool same(const Decision& x, const Decision& y) {
    return x.collides == y.collides && x.probability == y.probability && x.certain == y.certain && x.work == y.work &&
           x.stop == y.stop && x.witness == y.witness;
}

}  // namespace

DecideSettings anytimeSettings() {
    DecideSettings settings;
    settings.estimateSteps = unlimited;
    settings.acceptAt = 1;
    settings.rejectAt = 0;
    settings.tryWitness = false;  // the poses have no coherence
    return settings;
}

Series estimates(const Tree& a, const Tree& b, std::span<const Pose> poses, std::span<const char> truth,
                 std::span<const std::uint64_t> budgets, int repetitions, ResumeCheck& check) {
    Series series{"estimate", {}};
    for (const std::uint64_t steps : budgets) {
        series.at.push_back({steps, {}, {}, {}});
    }
    const DecideSettings settings = anytimeSettings();
    Query resumed(a, b);
    Query once(a, b);
    for (std::size_t i = 0; i < poses.size(); ++i) {
        std::uint64_t spent = 0;
        for (Stopped& at : series.at) {
            const Budget part{.work = at.steps - spent};
            const Decision decision = spent == 0 ? resumed.decide(poses[i], settings, part) : resumed.resume(part);
            spent = at.steps;
            at.forecasts.push_back({collisionProbability(decision), truth[i] != 0});
            at.work.push_back(static_cast<double>(decision.work));
            ++check.queries;
            check.otherEnds += same(decision, once.decide(poses[i], settings, {.work = at.steps})) ? 0 : 1;
        }
        const Decision end = resumed.resume({});
        check.otherEnds += same(end, once.decide(poses[i], settings)) ? 0 : 1;
        check.wrongInTheEnd += end.certain && end.collides == (truth[i] != 0) ? 0 : 1;
    }
    if (repetitions > 0) {
        for (Stopped& at : series.at) {
            const Contender timed = [&, query = Query(a, b)](std::size_t begin, std::size_t end) mutable {
                std::size_t yes = 0;
                for (std::size_t i = begin; i < end; ++i) {
                    yes += query.decide(poses[i], settings, {.work = at.steps}).collides ? 1U : 0U;
                }
                return yes;
            };
            at.us = leastUs(timed, poses.size(), repetitions);
        }
    }
    return series;
}

Series rival(std::string method, const Peer& peer, std::span<const Pose> poses, std::span<const char> truth,
             std::span<const std::uint64_t> budgets,
             const std::function<double(std::size_t pose, std::size_t budget)>& undecided) {
    Series series{std::move(method), {}};
    for (const std::uint64_t steps : budgets) {
        series.at.push_back({steps, {}, {}, {}});
    }
    for (std::size_t i = 0; i < poses.size(); ++i) {
        const Answer answer = peer.decide(poses[i]);
        for (std::size_t k = 0; k < budgets.size(); ++k) {
            const bool decided = answer.work <= budgets[k];
            const double probability = !decided ? undecided(i, k) : answer.collides ? 1 : 0;
            series.at[k].forecasts.push_back({probability, truth[i] != 0});
            series.at[k].work.push_back(static_cast<double>(std::min(answer.work, budgets[k])));
        }
    }
    return series;
}

std::vector<Series> rivals(const Tree& tree, std::span<const Pose> poses, std::span<const char> truth,
                           const StoppedPrior& prior) {
    // Just beside one half: the answer is what the name says, and is known to be worth nothing.
    const auto no = [](std::size_t, std::size_t) { return 0.49; };
    const auto yes = [](std::size_t, std::size_t) { return 0.51; };
    const RelativeDistance distance(tree, tree);
    const Peer exact = queryPeer("exact", tree, tree, exactShuffled());
    std::vector<Series> all;
    all.push_back(rival("exact, else no", exact, poses, truth, stepBudgets, no));
    all.push_back(rival("exact, else prior", exact, poses, truth, stepBudgets,
                        [&](std::size_t pose, std::size_t k) { return prior.probability(k, distance(poses[pose])); }));
    for (const int triangles : truncations) {
        const Peer peer = truncatedPeer(tree, triangles);
        all.push_back(rival(peer.name + " triangles, else no", peer, poses, truth, stepBudgets, no));
        all.push_back(rival(peer.name + " triangles, else yes", peer, poses, truth, stepBudgets, yes));
    }
    return all;
}

void pool(std::vector<Series>& all, const std::vector<Series>& more) {
    const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
    for (const Series& series : more) {
        const auto found = std::ranges::find(all, series.method, &Series::method);
        if (found == all.end()) {
            all.push_back(series);
            continue;
        }
        for (std::size_t k = 0; k < series.at.size(); ++k) {
            append(found->at[k].forecasts, series.at[k].forecasts);
            append(found->at[k].work, series.at[k].work);
            append(found->at[k].us, series.at[k].us);
        }
    }
}

Series bestOf(const std::vector<Series>& all, const std::string& beginning) {
    Series best{beginning, {}};
    std::vector<double> least;
    for (const Series& series : all) {
        for (std::size_t k = 0; series.method.starts_with(beginning) && k < series.at.size(); ++k) {
            const double error = score(series.at[k].forecasts).errorPercent;
            if (k == best.at.size()) {
                best.at.push_back(series.at[k]);
                least.push_back(error);
            } else if (error < least[k]) {
                best.at[k] = series.at[k];
                least[k] = error;
            }
        }
    }
    return best;
}

std::vector<report::Row> rowsOf(const Series& series, const std::string& scenario, const std::string& mesh,
                                std::size_t triangles) {
    std::vector<report::Row> rows;
    for (const Stopped& at : series.at) {
        const Score result = score(at.forecasts);
        report::Row& row = rows.emplace_back();
        row.scenario = scenario;
        row.mesh = mesh;
        row.triangles = triangles;
        row.method = series.method;
        row.n = result.n;
        row.colliding = static_cast<double>(result.colliding);
        row.falseNegatives = result.falseNegatives;
        row.falsePositives = result.falsePositives;
        row.timeUs = report::quantiles(at.us);
        const report::Quantiles work = report::quantiles(at.work);
        row.work = {{"steps", static_cast<double>(at.steps)},
                    {"workMean", work.mean},
                    {"workP99", work.p99},
                    {"workMax", work.max}};
        row.measured = {{"errorPct", result.errorPercent},
                        {"auc", result.auc},
                        {"brier", result.brier},
                        {"ece", result.ece},
                        {"eceEqualCount", result.eceEqualCount},
                        {"inDoubt", static_cast<double>(result.inDoubt)},
                        {"eceInDoubt", result.eceInDoubt}};
    }
    return rows;
}

}  // namespace grapeshot::bench
