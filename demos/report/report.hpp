// What every suite hands back: rows and claims; printed for people and written as JSON.
//
// One schema for all suites: {suite, commit, cpu, isa, compiler, seed, quick, rows: [{scenario, mesh, triangles,
// method, peer, n, falseNegatives, falsePositives, colliding, timeUs {p50, p95, p99, max, mean}, work {...}, measured
// {...}, curves {name: [...]}, ratio}], claims: [{claim, value, relation, bound, holds}]}. Numbers that do not apply
// are null.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace grapeshot::report {

inline constexpr double notApplicable = std::numeric_limits<double>::quiet_NaN();

struct Quantiles {
    double p50 = notApplicable, p95 = notApplicable, p99 = notApplicable, max = notApplicable, mean = notApplicable;
};

/// Nearest rank; all not applicable if there are no values.
[[nodiscard]] Quantiles quantiles(std::vector<double> values);

/// The value of that rank, q in 0..1, nearest rank; not applicable if there are no values.
[[nodiscard]] double quantile(std::vector<double> values, double q);

/// Not applicable if there are no values.
[[nodiscard]] double mean(const std::vector<double>& values);

/// Of values > 0 (0 if one is 0); not applicable if there are none.
[[nodiscard]] double geometricMean(const std::vector<double>& values);

/// Middle of an odd number of values, mean of the two middle ones of an even number.
[[nodiscard]] double median(std::vector<double> values);

/// max / min - 1 of repetitions of one measurement.
[[nodiscard]] double spread(const std::vector<double>& values);

using NamedNumbers = std::vector<std::pair<std::string, double>>;
using NamedCurves = std::vector<std::pair<std::string, std::vector<double>>>;

struct Row {
    std::string scenario, mesh;
    std::size_t triangles = 0;
    std::string method, peer;
    std::size_t n = 0;  ///< poses or steps
    double falseNegatives = notApplicable, falsePositives = notApplicable, colliding = notApplicable;
    Quantiles timeUs;
    NamedNumbers work;             ///< counts: the same on every machine
    NamedNumbers measured;         ///< other results of the scenario, unit in the name
    NamedCurves curves;            ///< results over something, say a distance: in JSON only, a table has no room
    double ratio = notApplicable;  ///< the peer's time / the method's
};

struct Claim {
    std::string claim;
    double value = 0;
    bool atLeast = true;  ///< value >= bound, else value <= bound
    double bound = 0;
    [[nodiscard]] bool holds() const { return atLeast ? value >= bound : value <= bound; }
};

struct Report {
    std::string suite;
    std::uint64_t seed = 0;
    bool quick = false;
    std::vector<Row> rows;
    std::vector<Claim> claims;
    [[nodiscard]] bool holds() const;
};

/// Rows as aligned columns; the columns are the numbers that any row has.
[[nodiscard]] std::string table(const Report& report);
[[nodiscard]] std::string json(const Report& report);

}  // namespace grapeshot::report
