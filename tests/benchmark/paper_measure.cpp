#include "paper_measure.hpp"

#include <cmath>

#include <grapeshot/adb/query.hpp>

#include "clearance.hpp"

namespace grapeshot::bench {

PaperTruth truthOf(const PaperModel& model, const Turns& turns) {
    // In single precision poses closer than this to touching may go either way, m.
    constexpr double borderline = 4e-6;
    const Tree tree = build(model.mesh.view());
    Query library(tree, tree);
    reference::ExactQuery<reference::Box> boxes(model.boxes, model.boxes);
    reference::ExactQuery<PaperDop> dops(model.dops, model.dops);
    PaperTruth truth;
    for (const std::vector<Pose>& poses : turns.poses) {
        std::vector<char>& answers = truth.collides.emplace_back();
        for (const Pose& pose : poses) {
            const reference::ExactAnswer byBoxes = boxes.decide(pose);
            const reference::ExactAnswer byDops = dops.decide(pose);
            answers.push_back(byBoxes.collides ? 1 : 0);
            ++truth.poses;
            truth.boxTests += static_cast<double>(byBoxes.volumeTests);
            truth.dopTests += static_cast<double>(byDops.volumeTests);
            truth.betweenExact += byBoxes.collides != byDops.collides ? 1U : 0U;
            if (library.decide(pose, DecideSettings::exact()).collides != byBoxes.collides) {
                const double gap = clearance(model.mesh.view(), model.mesh.view(), pose, 100 * borderline);
                truth.withLibrary += std::abs(gap) > borderline ? 1U : 0U;
            }
        }
    }
    truth.boxTests /= static_cast<double>(truth.poses);
    truth.dopTests /= static_cast<double>(truth.poses);
    return truth;
}

PaperErrors& PaperErrors::operator+=(const PaperErrors& other) {
    n += other.n;
    colliding += other.colliding;
    falseNegatives += other.falseNegatives;
    falsePositives += other.falsePositives;
    gaveUp += other.gaveUp;
    pairs += other.pairs;
    volumeTests += other.volumeTests;
    estimates += other.estimates;
    triangleTests += other.triangleTests;
    return *this;
}

double meanPercent(const std::vector<PaperErrors>& errors, const Turns& turns, double low, double high) {
    double sum = 0;
    double count = 0;
    for (std::size_t d = 0; d < errors.size(); ++d) {
        if (turns.distances[d] > low - 1e-9 && turns.distances[d] < high + 1e-9) {
            sum += errors[d].percent();
            ++count;
        }
    }
    return count > 0 ? sum / count : 0;
}

PaperErrors total(const std::vector<PaperErrors>& errors) {
    PaperErrors sum;
    for (const PaperErrors& one : errors) {
        sum += one;
    }
    return sum;
}

}  // namespace grapeshot::bench
