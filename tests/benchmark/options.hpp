// The command line of grapeshot_bench.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <grapeshot/core/instruction_set.hpp>

namespace grapeshot::bench {

/// Centre distances, m.
struct DistanceRange {
    double low = 0.4;
    double high = 2.1;
    double step = 0.05;
};

struct Options {
    std::string suite;  ///< anytime | contacts | decide | fit | guarantee | paper | scene | soft | stochastic |
                        ///< tracking | trees | workloads
    std::vector<std::string> meshes;     ///< files in place of the generated meshes (not scene; paper: the shown ones)
    std::vector<std::string> scenarios;  ///< only these; empty: all
    bool quick = false;                  ///< a sample: counts are still checked, times are not claimed
    std::optional<int> poses;            ///< per mesh (decide, anytime), per distance (paper)
    DistanceRange distances;             ///< paper
    std::string plotFolder;              ///< anytime, contacts, paper, stochastic; empty: no plots
    std::optional<int> repetitions;      ///< of every timed measurement; episodes per scene (stochastic)
    std::uint64_t seed = 20031119;
    std::string jsonFile;
    std::string outputFile;  ///< the calibration (fit)
    std::optional<InstructionSet> instructionSet;
    bool help = false;
};

/// @throws std::invalid_argument that names the argument and what was expected
[[nodiscard]] Options parse(int argumentCount, const char* const* arguments);

[[nodiscard]] std::string usage();

}  // namespace grapeshot::bench
