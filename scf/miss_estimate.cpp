#include <grapeshot/scf/miss_estimate.hpp>

#include <algorithm>
#include <cmath>

#include <grapeshot/core/rate_bound.hpp>

namespace grapeshot {

void estimateMissed(MissEstimate& miss, bool complete, double draw) noexcept {
    if (!complete) {
        return;
    }
    const std::uint64_t finished = miss.sampled - miss.open;
    const std::uint64_t left = miss.unknown - miss.sampled + miss.open;
    if (left == 0) {
        miss.missed = 0;
    } else if (finished > 0) {
        miss.missed = static_cast<double>(left) * static_cast<double>(miss.hits) / static_cast<double>(finished);
    }
    constexpr double confidence = 0.95;
    const std::uint64_t most = upperCount(miss.hits + miss.open, miss.sampled, miss.unknown, confidence, draw);
    miss.missedBound = static_cast<double>(std::max(most - miss.hits, std::min<std::uint64_t>(left, 1)));
}

void estimateUnseen(MissEstimate& miss, std::uint64_t once, std::uint64_t dives) noexcept {
    if (dives == 0) {
        return;
    }
    const auto n = static_cast<double>(dives);
    const auto f1 = static_cast<double>(once);
    miss.unseen = f1 / n;
    miss.unseenBound = std::min(1.0, (f1 + 2 * std::sqrt(f1 + 1) + 1) / n);
}

}  // namespace grapeshot
