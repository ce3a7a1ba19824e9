// Methods on the same poses: who is wrong how often, and whose time is how many times whose.
#pragma once

#include <string>
#include <vector>

#include <report/report.hpp>
#include <support/poses.hpp>

#include "interleave.hpp"
#include "peer.hpp"
#include "truth.hpp"

namespace grapeshot::bench {

struct PosedPair {
    std::string scenario, mesh;
    std::size_t triangles;
    const test::PoseSet& set;
    const Truth& truth;
};

/// A row for each of the methods; the first is our exact traversal and the second, unless told otherwise, FCL, and
/// every row has the ratio to both. `measured`: errorPct, ratioToExact; `curves`: wrong answers by distance.
/// @param peer whose time `ratio` is about
[[nodiscard]] std::vector<report::Row> compare(const PosedPair& where, const std::vector<Peer>& methods,
                                               int repetitions, std::size_t peer = 1);

/// Mean time of one of the methods; `ratio` to the peer; ratioToExact, to the first.
void addRatios(const std::vector<Times>& times, std::size_t method, std::size_t peer, report::Row& row);
/// workMean, workP50, workP99, workMax per query; nothing if the method does not count.
void addWork(const std::vector<double>& work, report::Row& row);

/// What a method does over all meshes of a scenario, from its rows.
struct Overall {
    std::string method;
    std::size_t meshes = 0, poses = 0;
    double ratioToFcl = 0, ratioToExact = 0;  ///< geometric means
    double errorPercent = 0, worstErrorPercent = 0;
    [[nodiscard]] report::Row row(const std::string& scenario) const;
};
[[nodiscard]] std::vector<Overall> overall(const std::vector<report::Row>& rows, const std::string& scenario);

/// @throws std::logic_error if there is none
[[nodiscard]] const Overall& of(const std::vector<Overall>& all, const std::string& method);

/// A number of a row by its name; not applicable if it has none.
[[nodiscard]] double measured(const report::Row& row, const std::string& name);

}  // namespace grapeshot::bench
