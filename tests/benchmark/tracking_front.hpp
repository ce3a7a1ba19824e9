// What the front that is kept from step to step is worth, by how fast the surfaces move.
#pragma once

#include <cstdint>

#include <report/report.hpp>

namespace grapeshot::bench {

/// The two bodies and the coil of 100k triangles at several speeds, down to rest: every mode with the front laid anew
/// in every step and with the one that is kept, displacements given or measured, in turn.
void addFrontRows(std::uint64_t seed, bool quick, report::Report& results);

}  // namespace grapeshot::bench
