// What has to hold in `decide` and `anytime`, and the settings that it has to hold for: all in one place.
#pragma once

#include <optional>

#include <grapeshot/adb/query.hpp>
#include <grapeshot/core/instruction_set.hpp>

namespace grapeshot::bench {

/// So many times as fast as the exact traversal, geometric mean over the meshes, wrong in at most so many percent of
/// the poses, mean over the meshes.
struct Gate {
    double speedUp;
    double errorPercent;
};

/// An estimate that never hands over to the exact traversal, by how sure it must be to stop; for poses without
/// coherence.
struct EstimateSetting {
    const char* name;
    float acceptAt, rejectAt;
    Gate gate;
    [[nodiscard]] DecideSettings settings() const {
        DecideSettings result;
        result.estimateSteps = unlimited;
        result.acceptAt = acceptAt;
        result.rejectAt = rejectAt;
        result.tryWitness = false;
        return result;
    }
};
/// The limits are those of `grapeshot_bench decide --scenario limits`, which tries them on the meshes for fitting.
inline constexpr EstimateSetting estimateSettings[] = {{"estimate4", 0.586F, 0.414F, {7, 4}},
                                                       {"estimate07", 0.931F, 0.0588F, {4, 0.7}},
                                                       {"estimate005", 0.9984F, 0.0019F, {2.3, 0.05}}};

/// The default, on poses without coherence.
[[nodiscard]] inline DecideSettings hybridShuffled() {
    DecideSettings settings;
    settings.tryWitness = false;
    return settings;
}
inline constexpr Gate hybridShuffledGate{2, 0.05};
inline constexpr Gate hybridGrazingGate{0.98, 0.5};
/// Of the default on shells inside each other, all gaps together; there speed is not the question.
inline constexpr double mostNestedErrorPercent = 0.5;

/// FCL's time / that of the exact traversal.
[[nodiscard]] inline std::optional<double> leastRatioToFcl() {
    switch (instructionSet()) {
        case InstructionSet::avx512:
            return 25;
        case InstructionSet::avx2:
            return 15;
        case InstructionSet::scalar:
            break;
    }
    return {};
}

/// The anytime answers on Zachmann's poses: wrong in at most so many percent after so many steps.
struct StepGate {
    std::uint64_t steps;
    double errorPercent;
};
inline constexpr StepGate stepGates[] = {{1, 8}, {2, 4}, {4, 2}, {8, 1}};
inline constexpr double largestCalibrationError = 0.01;
inline constexpr double largestCalibrationErrorInDoubt = 0.05;  ///< of answers with a probability from 0.1 to 0.9

/// Contact regions after so many steps, against the fastest decimated mesh that is as good.
struct ContactGate {
    std::uint64_t steps;
    double speedUp;
    double regionCalibrationError;
};
inline constexpr ContactGate contactGate{8, 3, 0.05};

}  // namespace grapeshot::bench
