// What the scenarios have in common: margins, methods that stand beside ours, rows, claims.
#pragma once

#include <array>
#include <string>
#include <vector>

#include <report/report.hpp>

#include "options.hpp"
#include "scene_quality.hpp"

namespace grapeshot::bench {

/// Every gate holds at both, m.
inline constexpr std::array sceneMargins{0.02, 0.04};
[[nodiscard]] std::string atMargin(double margin);

/// How often a method's scene is run if the options do not say: of times each step's least counts.
[[nodiscard]] int runsOf(const Options& options);
/// The usual decomposition, of a coarser mesh if it must be quick.
[[nodiscard]] HullSettings hullSettings(const Options& options);

/// The row of one outcome.
[[nodiscard]] report::Row rowOf(const std::string& scenario, const std::string& mesh, const Outcome& outcome,
                                const Quality& quality);

/// Adds a row for each and returns what was judged. Ratios are to the method of that name, if it is among them.
std::vector<Quality> addRows(const std::string& scenario, const std::string& mesh, const std::vector<Outcome>& outcomes,
                             const std::string& peer, report::Report& results);

/// Adds claims that begin alike.
class Claims {
  public:
    Claims(std::string label, report::Report& results) : m_label(std::move(label)), m_results(results) {}
    void atLeast(const std::string& what, double value, double bound) { add(what, value, true, bound); }
    void atMost(const std::string& what, double value, double bound) { add(what, value, false, bound); }

  private:
    void add(const std::string& what, double value, bool atLeast, double bound) {
        m_results.claims.push_back({m_label + ": " + what, value, atLeast, bound});
    }

    std::string m_label;
    report::Report& m_results;
};

/// Mean contacts of a step.
[[nodiscard]] double meanContacts(const Run& run);

}  // namespace grapeshot::bench
