// Where the preloaded library says what it does.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <string>

#include <grapeshot/plugin/preload/take_over.hpp>

namespace grapeshot::preload {

/// A line, appended to the file that GRAPESHOT_PRELOAD_LOG names, else on standard error.
inline void logLine(const std::string& text) {
    const char* file = std::getenv(logVariable);
    std::FILE* log = file != nullptr && *file != '\0' ? std::fopen(file, "a") : nullptr;
    std::fprintf(log != nullptr ? log : stderr, "grapeshot: %s\n", text.c_str());
    if (log != nullptr) {
        std::fclose(log);
    }
}

}  // namespace grapeshot::preload
