// grapeshot_bench tracking --scenario fit: spacing, budget and the rest of the coils' settings, on a coil that no other
// row reports.
#pragma once

#include <cstdint>

#include <report/report.hpp>

namespace grapeshot::bench {

/// What the settings that the coils are reported with were chosen among: time, and coverage at one tube radius as the
/// mean and the worst of six seeds.
void addFitRows(std::uint64_t seed, bool quick, report::Report& results);

}  // namespace grapeshot::bench
