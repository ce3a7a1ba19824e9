// `grapeshot_bench trees`: what a tree costs beside FCL's: memory, building, refit.
#pragma once

#include <report/report.hpp>

#include "options.hpp"

namespace grapeshot::bench {

/// Per mesh. Claimed is only that the answers after a refit are right: those of FCL after its own, and those of a tree
/// that is built anew.
[[nodiscard]] report::Report runTreesSuite(const Options& options);

}  // namespace grapeshot::bench
