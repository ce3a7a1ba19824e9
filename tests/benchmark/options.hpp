// The command line of grapeshot_bench.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <grapeshot/core/instruction_set.hpp>

namespace grapeshot::bench {

struct Options {
    std::string suite;                   ///< decide | scene
    std::vector<std::string> meshes;     ///< files in place of the generated meshes (decide)
    std::vector<std::string> scenarios;  ///< only these; empty: all
    bool quick = false;                  ///< a sample: counts are still checked, times are not claimed
    std::optional<int> poses;            ///< per mesh
    std::optional<int> repetitions;      ///< of every timed measurement
    std::uint64_t seed = 20031119;
    std::string jsonFile;
    std::optional<InstructionSet> instructionSet;
    bool help = false;
};

/// @throws std::invalid_argument that names the argument and what was expected
[[nodiscard]] Options parse(int argumentCount, const char* const* arguments);

[[nodiscard]] std::string usage();

}  // namespace grapeshot::bench
