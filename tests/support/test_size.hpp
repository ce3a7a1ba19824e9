// How large a statistical test runs: a small sample by default, the full one when asked.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <string_view>

namespace grapeshot::test {

/// `full` if the environment says GRAPESHOT_TEST_SIZE=full (tests/run --all does), else `quick`.
inline std::size_t sampleSize(std::size_t quick, std::size_t full) {
    const char* size = std::getenv("GRAPESHOT_TEST_SIZE");
    return size != nullptr && std::string_view(size) == "full" ? full : quick;
}

}  // namespace grapeshot::test
