// The experiment of the stochastic papers, by their method in scf/reference.
#pragma once

#include <report/report.hpp>
#include "options.hpp"

namespace grapeshot::bench {

/// Collisions found after k steps, with and without the incomplete hierarchy, at the same number of new pairs, on five
/// scenes; and one part of the method at a time taken out or put in. With `--scenario fit` the choice of the free
/// parameters on other scenes instead.
[[nodiscard]] report::Report runStochasticSuite(const Options& options);

}  // namespace grapeshot::bench
