#include <algorithm>
#include <functional>
#include <memory>
#include <span>
#include <type_traits>
#include <utility>

#include "comparison.hpp"
#include "fcl_model.hpp"
#include "gates.hpp"
#include "stopped.hpp"
#include "unlike_pairs.hpp"
#include "workload_scenes.hpp"

namespace grapeshot::bench {

namespace {

/// A peer for all pairs at once.
struct Method {
    std::string name;
    std::function<Answer(std::size_t question)> decide;
    Contender contender;
};

/// @param ofPair from the two meshes' indices to what answers for them, itself from a pose
template <class OfPair>
Method methodOf(std::string name, const UnlikePairs& unlike, const OfPair& ofPair) {
    using Decide = std::invoke_result_t<const OfPair&, std::size_t, std::size_t>;
    const auto deciders = std::make_shared<std::vector<Decide>>();
    for (const auto& [a, b] : unlike.pairs) {
        deciders->push_back(ofPair(a, b));
    }
    const auto decide = [deciders, questions = std::span(unlike.questions)](std::size_t i) {
        return answerOf((*deciders)[questions[i].pair](questions[i].pose));
    };
    return {std::move(name), decide, [decide](std::size_t begin, std::size_t end) {
                std::size_t yes = 0;
                for (std::size_t i = begin; i < end; ++i) {
                    yes += decide(i).collides ? 1U : 0U;
                }
                return yes;
            }};
}

std::vector<Method> methodsFor(const std::vector<TreeOf>& meshes, const std::vector<FclModel>& models,
                               const UnlikePairs& unlike) {
    const auto ours = [&](std::string name, const DecideSettings& settings) {
        return methodOf(std::move(name), unlike, [&](std::size_t a, std::size_t b) {
            return [query = Query(*meshes[a].tree, *meshes[b].tree), settings](const Pose& pose) mutable {
                return query.decide(pose, settings);
            };
        });
    };
    std::vector<Method> methods{ours("exact", exactShuffled()),
                                methodOf("FCL OBBRSS", unlike,
                                         [&](std::size_t a, std::size_t b) {
                                             return [a = models[a], b = models[b]](const Pose& pose) {
                                                 return a.collides(b, pose);
                                             };
                                         }),
                                ours("hybrid", hybridShuffled())};
    for (const EstimateSetting& estimate : estimateSettings) {
        methods.push_back(ours(estimate.name, estimate.settings()));
    }
    return methods;
}

/// Pair by pair, in the order of the questions.
std::vector<char> truthOf(const std::vector<TreeOf>& meshes, const std::vector<FclModel>& models,
                          const UnlikePairs& unlike, WorkloadCheck& check) {
    std::vector<char> collides(unlike.questions.size());
    for (std::size_t pair = 0; pair < unlike.pairs.size(); ++pair) {
        const auto& [a, b] = unlike.pairs[pair];
        const std::vector<std::size_t> questions = unlike.of(pair);
        const Truth truth = checkedTruth(meshes[a].name + ", " + meshes[b].name, *meshes[a].tree, *meshes[b].tree,
                                         unlike.poses(questions), fclPeer(models[a], models[b]));
        check.disagreements += static_cast<double>(truth.disagreements);
        check.uncertain += static_cast<double>(truth.uncertain);
        check.colliding += static_cast<double>(truth.colliding);
        for (std::size_t i = 0; i < questions.size(); ++i) {
            collides[questions[i]] = truth.collides[i];
        }
    }
    check.poses += static_cast<double>(collides.size());
    return collides;
}

}  // namespace

std::vector<report::Row> unlikeRows(const std::vector<TreeOf>& meshes, int questions, int repetitions,
                                    std::uint64_t seed, WorkloadCheck& check) {
    const UnlikePairs unlike = unlikePairs(meshes, static_cast<std::size_t>(questions), seed);
    std::vector<FclModel> models;
    for (const TreeOf& mesh : meshes) {
        models.emplace_back(mesh.tree->mesh());
    }
    const std::vector<char> truth = truthOf(meshes, models, unlike, check);
    const std::vector<Method> methods = methodsFor(meshes, models, unlike);
    std::vector<Contender> contenders;
    for (const Method& method : methods) {
        contenders.push_back(method.contender);
    }
    const std::vector<Times> times = interleaved(contenders, truth.size(), repetitions);
    std::vector<report::Row> rows;
    for (std::size_t m = 0; m < methods.size(); ++m) {
        report::Row& row = rows.emplace_back();
        row.scenario = "unlike";
        row.mesh = std::to_string(meshes.size()) + " meshes";
        row.method = methods[m].name;
        row.peer = methods[1].name;
        row.n = truth.size();
        row.colliding = static_cast<double>(std::ranges::count(truth, 1));
        Errors errors;
        std::vector<double> work;
        for (std::size_t i = 0; i < truth.size(); ++i) {
            const Answer answer = methods[m].decide(i);
            errors.add(answer.collides, truth[i] != 0);
            work.push_back(static_cast<double>(answer.work));
        }
        row.falseNegatives = errors.falseNegatives;
        row.falsePositives = errors.falsePositives;
        addWork(work, row);
        row.timeUs = report::quantiles(leastUs(contenders[m], truth.size(), repetitions));
        row.measured = {{"errorPct", errors.percentOf(row.n)},
                        {"totalMs", 1e-3 * report::median(times[m]) * static_cast<double>(row.n)}};
        addRatios(times, m, 1, row);
    }
    return rows;
}

}  // namespace grapeshot::bench
