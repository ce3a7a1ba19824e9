#include <grapeshot/narrowphase/schedule.hpp>

#include <algorithm>
#include <cassert>
#include <limits>
#include <numeric>
#include <vector>

namespace grapeshot {
namespace {

constexpr double leastImportance = 1e-6;
constexpr double mostImportance = 1e6;

std::uint64_t saturatedSum(std::uint64_t x, std::uint64_t y) {
    return x > unlimited - y ? unlimited : x + y;
}

/// A pair that may get portions; the quotient weight / (dealt + 1) says whose turn it is.
struct Claim {
    std::size_t index = 0;
    std::uint64_t key = 0;
    double weight = 0;
    std::uint64_t most = 0;   // portions that it wants
    std::uint64_t dealt = 0;  // portions that it has

    [[nodiscard]] double quotient() const { return weight / static_cast<double>(dealt + 1); }
};

/// Is it the turn of `y` before that of `x`?
bool isLater(const Claim& x, const Claim& y) {
    const double left = x.quotient();
    const double right = y.quotient();
    if (left != right) {
        return left < right;
    }
    return x.dealt != y.dealt ? x.dealt > y.dealt : x.key > y.key;
}

/// Portions whose quotients are at least `level`.
std::uint64_t portionsAbove(double level, const Claim& claim) {
    const double ratio = claim.weight / level;
    if (ratio >= 0x1p52) {  // beyond it, counts are not exact in floating point
        return std::min(static_cast<std::uint64_t>(std::min(ratio, 0x1p62)), claim.most);
    }
    auto count = static_cast<std::uint64_t>(ratio);
    // Rounding of the ratio: what counts is the quotient as `isLater` sees it.
    while (count > 0 && claim.weight / static_cast<double>(count) < level) {
        --count;
    }
    while (claim.weight / static_cast<double>(count + 1) >= level) {
        ++count;
    }
    return std::min(count, claim.most);
}

std::uint64_t dealAbove(double level, std::vector<Claim>& claims) {
    std::uint64_t sum = 0;
    for (Claim& claim : claims) {
        claim.dealt = portionsAbove(level, claim);
        sum = saturatedSum(sum, claim.dealt);
    }
    return sum;
}

/// The bulk of the portions at once: all whose quotients are above a level that does not use up the supply. Returns
/// how many are left for dealing one by one: not much more than there are claims.
std::uint64_t dealBulk(std::uint64_t portions, std::vector<Claim>& claims) {
    // As the level falls, those are satisfied first that want the least for their weight.
    std::vector<std::size_t> order(claims.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto satisfiedAt = [&](std::size_t i) { return claims[i].weight / static_cast<double>(claims[i].most); };
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t x, std::size_t y) { return satisfiedAt(x) > satisfiedAt(y); });
    double weight = 0;
    for (const Claim& claim : claims) {
        weight += claim.weight;
    }
    double level = 0;
    std::uint64_t satisfied = 0;
    for (const std::size_t i : order) {
        level = weight / static_cast<double>(portions - satisfied);
        if (level > satisfiedAt(i) || claims[i].most >= portions - satisfied) {
            break;
        }
        satisfied += claims[i].most;
        weight -= claims[i].weight;
    }
    level = std::max(level, std::numeric_limits<double>::min());
    std::uint64_t dealt = dealAbove(level, claims);
    while (dealt > portions) {  // rounding
        level *= 1 + 1e-9;
        dealt = dealAbove(level, claims);
    }
    return portions - dealt;
}

}  // namespace

double weightOf(const ScheduledPair& pair) noexcept {
    const auto importance = static_cast<double>(pair.importance);
    const double held =
        importance > leastImportance ? std::min(importance, mostImportance) : leastImportance;  // a NaN is the least
    return held * (1.0 + static_cast<double>(pair.age));
}

ScheduleSums schedule(std::span<const ScheduledPair> pairs, std::uint64_t budget, std::span<std::uint64_t> slices) {
    assert(pairs.size() == slices.size());
    ScheduleSums sums;
    std::vector<Claim> claims;
    std::uint64_t wantedPortions = 0;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const ScheduledPair& pair = pairs[i];
        slices[i] = pair.mandatory;
        sums.mandatory = saturatedSum(sums.mandatory, pair.mandatory);
        if (pair.wanted > pair.mandatory) {
            const std::uint64_t wanted = pair.wanted - pair.mandatory;
            const std::uint64_t most = wanted / slicePortion + (wanted % slicePortion != 0 ? 1 : 0);
            claims.push_back({i, pair.key, weightOf(pair), most, 0});
            wantedPortions = saturatedSum(wantedPortions, most);
        }
    }
    if (budget == unlimited) {
        std::fill(slices.begin(), slices.end(), unlimited);
        sums.slices = pairs.empty() ? 0 : unlimited;
        return sums;
    }
    sums.slices = sums.mandatory;
    if (budget <= sums.mandatory || claims.empty()) {
        return sums;
    }
    const std::uint64_t rest = budget - sums.mandatory;
    const std::uint64_t whole = std::min(rest / slicePortion, wantedPortions);
    // The sums of floating point numbers below must not depend on the order of the input.
    std::sort(claims.begin(), claims.end(),
              [](const Claim& x, const Claim& y) { return x.key != y.key ? x.key < y.key : x.weight < y.weight; });
    std::uint64_t left = 0;
    if (whole == wantedPortions) {
        for (Claim& claim : claims) {
            claim.dealt = claim.most;
        }
    } else {
        left = whole > 0 ? dealBulk(whole, claims) : 0;
    }
    std::vector<Claim> turns;
    std::vector<Claim> done;
    for (const Claim& claim : claims) {
        (claim.dealt < claim.most ? turns : done).push_back(claim);
    }
    std::make_heap(turns.begin(), turns.end(), isLater);
    for (; left > 0 && !turns.empty(); --left) {
        std::pop_heap(turns.begin(), turns.end(), isLater);
        Claim& turn = turns.back();
        if (++turn.dealt < turn.most) {
            std::push_heap(turns.begin(), turns.end(), isLater);
        } else {
            done.push_back(turn);
            turns.pop_back();
        }
    }
    std::uint64_t given = whole * slicePortion;
    const std::size_t next = turns.empty() ? pairs.size() : turns.front().index;
    for (const std::vector<Claim>* part : {&turns, &done}) {
        for (const Claim& claim : *part) {
            slices[claim.index] += claim.dealt * slicePortion;
        }
    }
    if (next < pairs.size()) {  // the last portion is not a whole one
        slices[next] += rest - given;
        given = rest;
    }
    sums.slices += given;
    return sums;
}

}  // namespace grapeshot
