#include <utility>

#include <support/poses.hpp>

#include "anytime_scenes.hpp"
#include "gates.hpp"
#include "interleave.hpp"
#include "pose_sets.hpp"
#include "truth.hpp"

namespace grapeshot::bench {

namespace {

struct Question {
    std::size_t pair;
    Pose pose;
};

/// Ordered pairs of different meshes and the questions about them, in random order.
struct Questions {
    std::vector<std::pair<const Tree*, const Tree*>> pairs;
    std::vector<Question> list;
    std::vector<char> truth;
};

Questions questionsOf(const std::vector<TreeOf>& meshes, std::size_t count, std::uint64_t seed) {
    Questions questions;
    for (const TreeOf& a : meshes) {
        for (const TreeOf& b : meshes) {
            if (a.tree != b.tree) {
                questions.pairs.emplace_back(a.tree, b.tree);
            }
        }
    }
    const std::size_t perPair = (count + questions.pairs.size() - 1) / questions.pairs.size();
    const int perDistance = static_cast<int>((perPair + zachmannDistances - 1) / zachmannDistances);
    for (std::size_t i = 0; i < questions.pairs.size(); ++i) {
        const auto& [a, b] = questions.pairs[i];
        for (const Pose& pose : test::zachmannPoses(*a, *b, zachmannDistances, perDistance, seed + i).poses) {
            questions.list.push_back({i, pose});
        }
    }
    test::Random random(seed);
    for (std::size_t i = questions.list.size(); i > 1; --i) {
        std::swap(questions.list[i - 1], questions.list[random.bits() % i]);
    }
    questions.list.resize(std::min(count, questions.list.size()));
    return questions;
}

/// A query per pair, and one setting for all.
class Asker {
  public:
    Asker(const Questions& questions, const DecideSettings& settings) : m_questions(&questions), m_settings(settings) {
        for (const auto& [a, b] : questions.pairs) {
            m_queries.emplace_back(*a, *b);
        }
    }
    Decision operator()(std::size_t question) {
        const Question& asked = m_questions->list[question];
        return m_queries[asked.pair].decide(asked.pose, m_settings);
    }
    std::size_t operator()(std::size_t begin, std::size_t end) {
        std::size_t yes = 0;
        for (std::size_t i = begin; i < end; ++i) {
            yes += (*this)(i).collides ? 1U : 0U;
        }
        return yes;
    }

  private:
    const Questions* m_questions;
    DecideSettings m_settings;
    std::vector<Query> m_queries;
};

/// What the anytime answers say, pair by pair.
Series estimatesOf(const Questions& questions, ResumeCheck& check) {
    std::vector<Series> all;
    for (std::size_t pair = 0; pair < questions.pairs.size(); ++pair) {
        std::vector<Pose> poses;
        std::vector<char> truth;
        for (std::size_t i = 0; i < questions.list.size(); ++i) {
            if (questions.list[i].pair == pair) {
                poses.push_back(questions.list[i].pose);
                truth.push_back(questions.truth[i]);
            }
        }
        const auto& [a, b] = questions.pairs[pair];
        pool(all, {estimates(*a, *b, poses, truth, stepBudgets, 0, check)});
    }
    return all.front();
}

}  // namespace

std::vector<report::Row> unlikePairs(const std::vector<TreeOf>& meshes, int pairs, int repetitions, std::uint64_t seed,
                                     ResumeCheck& check) {
    Questions questions = questionsOf(meshes, static_cast<std::size_t>(pairs), seed);
    Asker exact(questions, exactShuffled());
    double colliding = 0;
    for (std::size_t i = 0; i < questions.list.size(); ++i) {
        questions.truth.push_back(exact(i).collides ? 1 : 0);
        colliding += questions.truth.back();
    }
    std::vector<std::pair<std::string, Asker>> methods{{"exact", exact}, {"hybrid", {questions, hybridShuffled()}}};
    for (const EstimateSetting& estimate : estimateSettings) {
        methods.emplace_back(estimate.name, Asker(questions, estimate.settings()));
    }
    std::vector<Contender> contenders;
    for (const auto& [name, asker] : methods) {
        contenders.emplace_back(asker);
    }
    const std::vector<Times> times = interleaved(contenders, questions.list.size(), repetitions);
    std::vector<report::Row> rows;
    for (std::size_t m = 0; m < methods.size(); ++m) {
        report::Row& row = rows.emplace_back();
        row.scenario = "unlike pairs";
        row.mesh = std::to_string(meshes.size()) + " meshes";
        row.method = methods[m].first;
        row.peer = "exact";
        row.n = questions.list.size();
        row.colliding = colliding;
        Errors errors;
        std::vector<double> work;
        for (std::size_t i = 0; i < questions.list.size(); ++i) {
            const Decision decision = methods[m].second(i);
            errors.add(decision.collides, questions.truth[i] != 0);
            work.push_back(static_cast<double>(decision.work));
        }
        row.falseNegatives = errors.falseNegatives;
        row.falsePositives = errors.falsePositives;
        row.timeUs = report::quantiles(leastUs(contenders[m], questions.list.size(), repetitions));
        row.timeUs.mean = report::median(times[m]);
        const std::vector<double> toExact = ratios(times[m], times[0]);
        row.ratio = report::median(toExact);
        const report::Quantiles units = report::quantiles(work);
        row.work = {{"workMean", units.mean}, {"workP99", units.p99}, {"workMax", units.max}};
        row.measured = {{"errorPct", errors.percentOf(row.n)}, {"ratioSpread", report::spread(toExact)}};
    }
    const std::vector<report::Row> atSteps =
        rowsOf(estimatesOf(questions, check), "unlike pairs", rows.front().mesh, 0);
    rows.insert(rows.end(), atSteps.begin(), atSteps.end());
    return rows;
}

}  // namespace grapeshot::bench
