// Error over all of tau x grid x pMin, and the two points that are taken to other models.
#pragma once

#include <vector>

#include <grapeshot/adb/reference/settings.hpp>
#include <report/report.hpp>

#include "paper_measure.hpp"

namespace grapeshot::bench {

struct Point {
    reference::FillSettings fill;
    double pMin = 0.99;
};

/// The traversal of all published plots, with its limit of time: what takes more pairs than this costs many times what
/// the exact answer does, and is answered "no".
[[nodiscard]] reference::Settings paperSettings(double pMin);

struct PaperSurface {
    std::vector<report::Row> rows;  ///< a row per model and point
    Point accurate;                 ///< least error among the points that are faster than the exact DOP-tree
    bool fasterThanExact = false;   ///< or simply the least error of all
    Point fast;  ///< fastest among those with at most 4 % of errors, the abstract's figure; or accurate
};

/// Measures every point on every model. Errors are means over the distances, of the worse model; faster is by counted
/// cost, on each of them.
[[nodiscard]] PaperSurface measureSurface(const std::vector<PaperModel>& models, const Turns& turns, bool quick);

/// Parameters of a point, for rows.
[[nodiscard]] report::NamedNumbers parameters(const Point& point, int kMin);
/// Counts into a row.
void fillRow(report::Row& row, const PaperErrors& errors, std::size_t queries);

}  // namespace grapeshot::bench
