// What the anytime answers say after so many steps, beside what the rivals would say after as many.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <report/report.hpp>

#include "peer.hpp"
#include "scoring.hpp"
#include "stopped.hpp"

namespace grapeshot::bench {

/// One method after so many steps.
struct Stopped {
    std::uint64_t steps = 0;
    std::vector<Forecast> forecasts;
    std::vector<double> work;  ///< of every query: not more than `steps`
    std::vector<double> us;    ///< of every query, or empty
};
struct Series {
    std::string method;
    std::vector<Stopped> at;
};

/// An estimate that goes on as long as it may: never sure before it is certain, never handing over.
[[nodiscard]] DecideSettings anytimeSettings();

/// Must all be 0.
struct ResumeCheck {
    double queries = 0;
    double otherEnds = 0;      ///< stopped and resumed, it says otherwise than in one go
    double wrongInTheEnd = 0;  ///< resumed without a budget, it is not certain or not right
};

/// Takes each pose up once, stopping after each of the budgets, which must rise; adds to the check. `repetitions`: of
/// the timing, 0 for none.
[[nodiscard]] Series estimates(const Tree& a, const Tree& b, std::span<const Pose> poses, std::span<const char> truth,
                               std::span<const std::uint64_t> budgets, int repetitions, ResumeCheck& check);

/// A rival that goes to its end, by how much work it takes: before that it says nothing, and then `undecided` stands
/// in.
/// @param undecided P(collide) by the index of pose and budget
[[nodiscard]] Series rival(std::string method, const Peer& peer, std::span<const Pose> poses,
                           std::span<const char> truth, std::span<const std::uint64_t> budgets,
                           const std::function<double(std::size_t pose, std::size_t budget)>& undecided);

/// The rivals on two copies of a mesh: the stopped exact traversal and truncated trees, with all ways to fill in.
[[nodiscard]] std::vector<Series> rivals(const Tree& tree, std::span<const Pose> poses, std::span<const char> truth,
                                         const StoppedPrior& prior);

/// Appends what `more` has to the series of the same methods.
void pool(std::vector<Series>& all, const std::vector<Series>& more);

/// Of the series whose names begin so, after each number of steps the one with the fewest errors: chosen afterwards,
/// which favours them.
[[nodiscard]] Series bestOf(const std::vector<Series>& all, const std::string& beginning);

/// A row for each number of steps.
[[nodiscard]] std::vector<report::Row> rowsOf(const Series& series, const std::string& scenario,
                                              const std::string& mesh, std::size_t triangles);

}  // namespace grapeshot::bench
