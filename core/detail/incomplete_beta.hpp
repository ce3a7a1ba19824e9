// The regularised incomplete beta function I_x(a, b), in logarithms, so that no tail is too small.
//
// This work is based on:
// Milton Abramowitz, Irene Stegun. Handbook of Mathematical Functions. 1964, 6.1.41 (Stirling's series), 26.5.8
// (the continued fraction)
// William Lentz. Generating Bessel functions in Mie scattering calculations using continued fractions. Applied Optics
// 15, 1976 (how to sum it up, as modified by Thompson and Barnett)
#pragma once

namespace grapeshot::detail {

/// log B(a, b); a, b > 0. Own gamma function: that of the C library writes to a global, and differs between machines.
[[nodiscard]] double logBeta(double a, double b) noexcept;

/// log I_x(a, b): x in [0, 1], a, b > 0. -infinity at x = 0. Relative error of I below 1e-9 for a + b up to 1e8; takes
/// about sqrt(max(a, b)) terms at worst.
[[nodiscard]] double logIncompleteBeta(double x, double a, double b) noexcept;

/// log(1 - I_x(a, b)), without the cancellation.
[[nodiscard]] double logIncompleteBetaAbove(double x, double a, double b) noexcept;

}  // namespace grapeshot::detail
