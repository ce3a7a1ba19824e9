#include <grapeshot/core/detail/incomplete_beta.hpp>

#include <cmath>
#include <limits>
#include <numbers>

namespace grapeshot::detail {
namespace {

double logGamma(double x) noexcept {
    // Stirling's series is good to the last bits from here on.
    constexpr double large = 10;
    double product = 1;
    while (x < large) {
        product *= x;
        x += 1;
    }
    const double y = 1 / (x * x);
    const double series =
        (1.0 / 12 - y * (1.0 / 360 - y * (1.0 / 1260 - y * (1.0 / 1680 - y * (1.0 / 1188 - y * 691.0 / 360360))))) / x;
    return (x - 0.5) * std::log(x) - x + 0.5 * std::log(2 * std::numbers::pi) + series - std::log(product);
}

/// The fraction of 26.5.8, for x below the middle (a + 1) / (a + b + 2), where it converges fast.
double continuedFraction(double x, double a, double b) noexcept {
    constexpr double tiny = 1e-300;
    constexpr int mostTerms = 200'000;
    const auto notZero = [](double value) { return std::abs(value) < tiny ? tiny : value; };
    double c = 1;
    double d = 1 / notZero(1 - (a + b) * x / (a + 1));
    double value = d;
    for (int i = 1; i < mostTerms; ++i) {
        const double m = i;
        const double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
        d = 1 / notZero(1 + even * d);
        c = notZero(1 + even / c);
        value *= c * d;
        const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
        d = 1 / notZero(1 + odd * d);
        c = notZero(1 + odd / c);
        value *= c * d;
        if (std::abs(c * d - 1) < 1e-15) {
            break;
        }
    }
    return value;
}

/// log I_x(a, b) where x is below the middle.
double logLower(double x, double a, double b) noexcept {
    return a * std::log(x) + b * std::log1p(-x) - std::log(a) - logBeta(a, b) + std::log(continuedFraction(x, a, b));
}

double logOneMinusExp(double x) noexcept {
    return x >= 0 ? -std::numeric_limits<double>::infinity() : std::log(-std::expm1(x));
}

}  // namespace

double logBeta(double a, double b) noexcept {
    return logGamma(a) + logGamma(b) - logGamma(a + b);
}

double logIncompleteBeta(double x, double a, double b) noexcept {
    if (x <= 0) {
        return -std::numeric_limits<double>::infinity();
    }
    if (x >= 1) {
        return 0;
    }
    return x < (a + 1) / (a + b + 2) ? logLower(x, a, b) : logOneMinusExp(logLower(1 - x, b, a));
}

double logIncompleteBetaAbove(double x, double a, double b) noexcept {
    return logIncompleteBeta(1 - x, b, a);
}

}  // namespace grapeshot::detail
