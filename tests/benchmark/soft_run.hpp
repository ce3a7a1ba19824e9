// Worlds with soft bodies stepped in turns, and their rows.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <report/report.hpp>

#include "options.hpp"
#include "soft_world.hpp"

namespace grapeshot::bench {

struct SoftCourse {
    std::string scenario;
    std::string mesh;
    int steps = 60;
    double limitSeconds = 30;  ///< of processor time after the first step: what has taken more is stepped no further
};

/// What a method made of a scene.
struct SoftOutcome {
    SoftMethod method;
    std::unique_ptr<SoftWorld> world;  ///< as it was left
    std::vector<SoftStep> steps;       ///< fewer than the course has if it took too long
    double workMean = 0;               ///< units of a step, 0 under Bullet's own
    int degraded = 0;                  ///< pairs that were cut short, all steps together
};

using SoftScene = std::function<std::unique_ptr<SoftWorld>(const SoftMethod&)>;

/// All methods in the same scene from the same state, step by step, taking turns in going first.
[[nodiscard]] std::vector<SoftOutcome> runSoft(const SoftCourse& course, const std::vector<SoftMethod>& methods,
                                               const SoftScene& scene);

/// Ours, and Bullet's own handlers, by that name.
[[nodiscard]] std::vector<SoftMethod> softMethods();
inline constexpr const char* bulletsOwn = "bullet";

/// Time of `of` / time of `to` over the steps that both made, the first ones left out: there trees are built.
[[nodiscard]] double softRatio(const SoftOutcome& of, const SoftOutcome& to, double SoftStep::*part);

using SoftJudge = std::function<report::NamedNumbers(const SoftWorld&)>;

/// Two rows of each method, whole step and collision, with what the judge says of the state it ended in. Ratios are
/// to Bullet's own.
void addSoftRows(const SoftCourse& course, const std::vector<SoftOutcome>& outcomes, const SoftJudge& judge,
                 report::Report& results);

}  // namespace grapeshot::bench
