#include <grapeshot/adb/reference/lower_bound.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <numbers>
#include <utility>

namespace grapeshot::reference {

double depthBound(int depthA, int depthB, int maxDepthA, int maxDepthB) {
    const int most = maxDepthA + maxDepthB;
    return most == 0 ? 1 : static_cast<double>(depthA + depthB) / most;
}

double planarBound(double tau) {
    // Any two planes through a cube: pi / 6.
    constexpr std::array<std::pair<double, double>, 8> measured{{{0, std::numbers::pi / 6},
                                                                 {0.3, 0.82},
                                                                 {0.5, 0.885},
                                                                 {0.6, 0.91},
                                                                 {0.7, 0.94},
                                                                 {0.8, 0.97},
                                                                 {0.9, 0.99},
                                                                 {1, 1}}};
    for (std::size_t i = 1; i < measured.size(); ++i) {
        if (tau <= measured[i].first) {
            const auto [low, atLow] = measured[i - 1];
            const auto [high, atHigh] = measured[i];
            return atLow + (std::max(tau, 0.0) - low) / (high - low) * (atHigh - atLow);
        }
    }
    return 1;
}

double curvatureBound(double tau, double halfAngle) {
    return planarBound(tau) * (1 - 0.22 * std::min(halfAngle, 2.0));
}

}  // namespace grapeshot::reference
