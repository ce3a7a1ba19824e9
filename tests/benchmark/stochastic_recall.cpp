#include "stochastic_recall.hpp"

#include <chrono>
#include <limits>
#include <optional>
#include <set>

#include <grapeshot/scf/reference/active_pairs.hpp>

#include "contact_ages.hpp"

namespace grapeshot::bench {

namespace {

using scf::reference::State;
using scf::reference::StepResult;
using scf::reference::Surface;

bool boxesMeet(const Placement& placement, float distance) {
    const auto box = [](const std::vector<Eigen::Vector3f>& vertices) {
        std::pair<Eigen::Array3f, Eigen::Array3f> bounds(vertices[0], vertices[0]);
        for (const Eigen::Vector3f& v : vertices) {
            bounds = {bounds.first.min(v.array()), bounds.second.max(v.array())};
        }
        return bounds;
    };
    const auto a = box(placement.a);
    const auto b = box(placement.b);
    return (a.first <= b.second + distance).all() && (b.first <= a.second + distance).all();
}

/// The first step with a contact, if there is one.
std::optional<int> firstContact(const ApproachScene& scene, std::uint64_t episode, float distance) {
    ContactAges truth(scene.a.view(), scene.b.view(), distance);
    for (int step = 0; step + stepsAfter <= lastStep(scene); ++step) {
        const Placement placement = place(scene, episode, step);
        if (boxesMeet(placement, distance) && !truth.next(placement.a, placement.b).ages.empty()) {
            return step;
        }
    }
    return std::nullopt;
}

struct TrueStep {
    Placement placement;
    TrueRegions regions;
};

std::vector<TrueStep> trueSteps(const ApproachScene& scene, std::uint64_t episode, int first, float distance) {
    ContactAges truth(scene.a.view(), scene.b.view(), distance);
    std::vector<TrueStep> steps;
    for (int step = first - stepsBefore; step < first + stepsAfter; ++step) {
        TrueStep one{place(scene, episode, step), {}};
        one.regions = truth.next(one.placement.a, one.placement.b);
        steps.push_back(std::move(one));
    }
    return steps;
}

void count(const StepResult& result, const TrueRegions& truth, Recall& recall) {
    std::set<std::size_t> found;
    for (const scf::reference::Contact& contact : result.contacts) {
        const auto pair = truth.regionOf.find({contact.triangleA, contact.triangleB});
        if (pair == truth.regionOf.end()) {
            ++recall.outside;
        } else {
            found.insert(pair->second);
        }
    }
    recall.reported += result.contacts.size();
    for (std::size_t r = 0; r < truth.ages.size(); ++r) {
        if (truth.ages[r] <= mostAge) {
            const auto age = static_cast<std::size_t>(truth.ages[r]);
            ++recall.regions[age];
            recall.found[age] += found.contains(r) ? 1 : 0;
        }
    }
}

Recall follow(const Surface& a, const Surface& b, const std::vector<TrueStep>& steps, StochasticMethod method,
              std::uint64_t episode) {
    method.settings.seed = episode;
    State state;
    Recall recall;
    for (const TrueStep& one : steps) {
        if (!method.remembers) {
            state.pairs.clear();
        }
        const auto before = std::chrono::steady_clock::now();
        const StepResult result = scf::reference::step(a, b, one.placement.a, one.placement.b, method.settings, state);
        const std::chrono::duration<double, std::micro> time = std::chrono::steady_clock::now() - before;
        recall.timeUs += time.count();
        ++recall.steps;
        recall.featureDistances += static_cast<double>(result.work.featureDistances);
        recall.trianglePairs += static_cast<double>(result.work.trianglePairs);
        recall.boxTests += static_cast<double>(result.work.boxTests);
        recall.regionsProposed += static_cast<double>(result.work.regions);
        recall.activePairs += static_cast<double>(state.pairs.size());
        count(result, one.regions, recall);
    }
    return recall;
}

}  // namespace

void Recall::add(const Recall& other) {
    for (std::size_t age = 1; age <= mostAge; ++age) {
        regions[age] += other.regions[age];
        found[age] += other.found[age];
    }
    reported += other.reported;
    outside += other.outside;
    steps += other.steps;
    featureDistances += other.featureDistances;
    trianglePairs += other.trianglePairs;
    boxTests += other.boxTests;
    activePairs += other.activePairs;
    regionsProposed += other.regionsProposed;
    timeUs += other.timeUs;
}

double Recall::share(int age) const {
    const auto i = static_cast<std::size_t>(age);
    return regions[i] == 0 ? std::numeric_limits<double>::quiet_NaN()
                           : static_cast<double>(found[i]) / static_cast<double>(regions[i]);
}

int Recall::stepsTo(double wanted) const {
    int first = mostAge + 1;
    for (int age = mostAge; age >= 1 && !(share(age) < wanted); --age) {
        first = age;
    }
    return first;
}

std::vector<Recall> measureRecall(const ApproachScene& scene, const std::vector<StochasticMethod>& methods,
                                  int episodes, std::uint64_t seed) {
    const Surface a = scf::reference::buildSurface(scene.a.view(), {.treeDepth = 12});
    const Surface b = scf::reference::buildSurface(scene.b.view(), {.treeDepth = 12});
    const float distance = methods.front().settings.maxDistance;
    std::vector<Recall> recalls(methods.size());
    int met = 0;
    for (std::uint64_t episode = seed; met < episodes && episode < seed + 10 * static_cast<std::uint64_t>(episodes);
         ++episode) {
        const std::optional<int> first = firstContact(scene, episode, distance);
        if (!first || *first < stepsBefore) {
            continue;
        }
        ++met;
        const std::vector<TrueStep> steps = trueSteps(scene, episode, *first, distance);
        for (std::size_t m = 0; m < methods.size(); ++m) {
            recalls[m].add(follow(a, b, steps, methods[m], episode));
        }
    }
    return recalls;
}

}  // namespace grapeshot::bench
