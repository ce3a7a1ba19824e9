// What the suite `stochastic` compares: the papers' methods, and one part at a time taken out or put in.
#pragma once

#include <string>
#include <vector>

#include <grapeshot/scf/reference/settings.hpp>

namespace grapeshot::bench {

struct StochasticMethod {
    std::string name;
    scf::reference::Settings settings;
    bool remembers = true;  ///< off: every step starts without pairs
};

/// Chosen by `--scenario fit`: pairs and moves such that without hierarchy the published row comes out best, then the
/// shallowest hierarchy within a point of the most that any depth finds in the first step.
struct FreeParameters {
    int newPairs = 20;
    int mostMoves = 15;
    int depth = 7;
    float maxDistance = 0.002F;  ///< 0.1 % of a body's diagonal
};

[[nodiscard]] scf::reference::Settings withParameters(scf::reference::Settings settings,
                                                      const FreeParameters& parameters);

/// The first is with hierarchy, the second without; all have the same number of new pairs unless their name says
/// otherwise.
[[nodiscard]] std::vector<StochasticMethod> stochasticMethods(const FreeParameters& parameters = {});

}  // namespace grapeshot::bench
