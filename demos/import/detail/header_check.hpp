// Does the file have room for what its header claims?
#pragma once

#include <cstdint>
#include <filesystem>

namespace grapeshot::import::detail {

/// Looks at OFF, PLY and binary STL, whose headers state counts that loaders allocate by and do not check: a claim of
/// 2^40 vertices in 300 bytes, a file that was cut off, an index with a minus sign. Other formats pass. Reads a text
/// file once, keeps a line at a time.
/// @throws Error badFile or indexOutOfRange, the place is file and line
void checkHeader(const std::filesystem::path& file, std::uintmax_t fileBytes);

}  // namespace grapeshot::import::detail
