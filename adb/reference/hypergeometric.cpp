#include <grapeshot/adb/reference/hypergeometric.hpp>

#include <algorithm>
#include <cmath>
#include <span>

namespace grapeshot::reference {

namespace {

/// Weights of P(c = t), t = 0 .. min(sA, sB), of which the sum is returned. Expects clamped bins.
double weigh(const Bins& bins, std::span<double> weight) {
    const auto [s, sA, sB] = bins;
    const int least = std::max(0, sA + sB - s);  // pigeonhole
    const int most = std::min(sA, sB);
    // P(t + 1) / P(t) = (sA - t) (sB - t) / ((t + 1) (s - sA - sB + t + 1))
    const auto up = [sA = sA, sB = sB](int t) { return static_cast<double>(sA - t) * (sB - t); };
    const auto down = [s = s, sA = sA, sB = sB](int t) { return static_cast<double>(t + 1) * (s - sA - sB + t + 1); };
    const auto at = [&](int t) -> double& { return weight[static_cast<std::size_t>(t)]; };
    const int mode = std::clamp(static_cast<int>((sA + 1.0) * (sB + 1.0) / (s + 2.0)), least, most);
    std::ranges::fill(weight, 0.0);
    double sum = at(mode) = 1;
    for (int t = mode; t < most; ++t) {
        sum += at(t + 1) = at(t) * up(t) / down(t);
    }
    for (int t = mode; t > least; --t) {
        sum += at(t - 1) = at(t) * down(t - 1) / up(t - 1);
    }
    return sum;
}

Tails tailsOf(const Bins& bins) {
    std::array<double, 512> few;
    std::vector<double> many;
    const auto count = static_cast<std::size_t>(std::min(bins.sA, bins.sB)) + 1;
    if (count > few.size()) {
        many.resize(count);
    }
    const std::span<double> weight = count > few.size() ? std::span(many) : std::span(few).first(count);
    const double sum = weigh(bins, weight);
    Tails tails{};
    double above = 0;
    for (std::size_t t = count - 1; t > 0; --t) {
        above += weight[t];
        if (t <= tails.size()) {
            tails[t - 1] = static_cast<float>(std::min(above / sum, 1.0));
        }
    }
    return tails;
}

}  // namespace

Bins Bins::clamped() const {
    const int most = std::max(s, 1);
    return {most, std::clamp(sA, 0, most), std::clamp(sB, 0, most)};
}

std::vector<double> collisionCellDistribution(const Bins& bins) {
    const Bins usable = bins.clamped();
    std::vector<double> distribution(static_cast<std::size_t>(std::min(usable.sA, usable.sB)) + 1);
    const double sum = weigh(usable, distribution);
    for (double& p : distribution) {
        p /= sum;
    }
    return distribution;
}

double atLeast(const Bins& bins, int x) {
    if (x <= 0) {
        return 1;
    }
    const std::vector<double> distribution = collisionCellDistribution(bins);
    double sum = 0;
    for (std::size_t t = distribution.size(); t-- > static_cast<std::size_t>(x);) {
        sum += distribution[t];
    }
    return std::min(sum, 1.0);
}

double expectedCollision(const Bins& bins, double lowerBound) {
    const std::vector<double> distribution = collisionCellDistribution(bins);
    double sum = 0;
    double none = 1;  // (1 - LB)^t
    for (const double p : distribution) {
        sum += p * (1 - none);
        none *= 1 - lowerBound;
    }
    return sum;
}

TailTable::TailTable(int bins) : m_bins(std::max(bins, 1)) {
    for (int s = 0; s <= m_bins; ++s) {
        m_start.push_back(m_tails.size());
        for (int sB = 0; sB <= s; ++sB) {
            for (int sA = 0; sA <= sB; ++sA) {
                m_tails.push_back(tailsOf({s, sA, sB}));
            }
        }
    }
}

std::size_t TailTable::index(const Bins& bins) const {
    const auto low = static_cast<std::size_t>(std::min(bins.sA, bins.sB));
    const auto high = static_cast<std::size_t>(std::max(bins.sA, bins.sB));
    return m_start[static_cast<std::size_t>(bins.s)] + high * (high + 1) / 2 + low;
}

Tails TailTable::operator()(const Bins& bins) const {
    const Bins usable = bins.clamped();
    return usable.s <= m_bins ? m_tails[index(usable)] : tailsOf(usable);
}

Tails TailTable::operator()(double s, double sA, double sB) const {
    const int bins = std::max(1, static_cast<int>(std::lround(s)));
    const double a = std::clamp(sA, 0.0, double(bins));
    const double b = std::clamp(sB, 0.0, double(bins));
    if (bins > m_bins && a >= 1 && b >= 1) {
        return (*this)(Bins{bins, static_cast<int>(std::lround(a)), static_cast<int>(std::lround(b))});
    }
    const int lowA = static_cast<int>(a);
    const int lowB = static_cast<int>(b);
    const auto upA = static_cast<float>(a - lowA);
    const auto upB = static_cast<float>(b - lowB);
    Tails sum{};
    const auto add = [&](int wholeA, int wholeB, float weight) {
        if (weight > 0) {
            const Tails tails = (*this)(Bins{bins, wholeA, wholeB});
            for (std::size_t x = 0; x < sum.size(); ++x) {
                sum[x] += weight * tails[x];
            }
        }
    };
    add(lowA, lowB, (1 - upA) * (1 - upB));
    add(lowA + 1, lowB, upA * (1 - upB));
    add(lowA, lowB + 1, (1 - upA) * upB);
    add(lowA + 1, lowB + 1, upA * upB);
    return sum;
}

const TailTable& tailTable() {
    static const TailTable table;
    return table;
}

double collisionProbability(const Tails& tails, double lowerBound, int mostCells) {
    double best = 0;
    double none = 1;  // (1 - LB)^x
    const int last = std::min(mostCells, tableLength);
    for (int x = 1; x <= last; ++x) {
        none *= 1 - lowerBound;
        best = std::max(best, double{tails[static_cast<std::size_t>(x - 1)]} * (1 - none));
    }
    return best;
}

}  // namespace grapeshot::reference
