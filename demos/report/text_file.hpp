// What programs write beside what they print.
#pragma once

#include <filesystem>
#include <string>

namespace grapeshot::report {

/// In place of what was there. @throws Error badFile, which names the file
void writeText(const std::filesystem::path& file, const std::string& text);

}  // namespace grapeshot::report
