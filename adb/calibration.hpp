// What the sum of rates is worth: the probability that two meshes collide, from what a traversal has seen of them.
//
// This work is based on:
// Jan Klein, Gabriel Zachmann. ADB-Trees: Controlling the Error of Time-Critical Collision Detection. VMV 2003, eq. 4
// (a probability per pair of nodes; here the pairs of a cut are taken for a Poisson field, whose rates add up, and what
// comes of it is put right by a table: 1 - exp(-rate) claims too much, because neighbouring pairs are alike)
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace grapeshot {

/// The rate at which two pieces of surface meet is 2^(constant + distance D^2 + length L), with the D^2 and L of
/// adb/README.md.
struct RateFormula {
    float constant = 0;
    float distance = 0;
    float length = 0;
};

/// A formula and a table, fitted together. A value; immutable once it is in use.
struct Calibration {
    static constexpr int version = 3;             ///< of the text form
    static constexpr std::size_t stepRows = 21;   ///< steps 1 to 16 each, 17-24, 25-32, 33-48, 49-64, more
    static constexpr std::size_t regionRows = 8;  ///< steps 1, 2, 3-4, 5-8, 9-16, 17-32, 33-64, more
    static constexpr std::size_t afterRows = 8;   ///< exact steps after the estimate: 0-3, 4-7, 8-15, ..., 256 and more
    static constexpr std::size_t knots = 41;      ///< rates 2^-10, 1.5 2^-10, 2^-9, ..., 2^10
    /// The row of so many steps, 1 or more. One step more takes about a sixth off what a rate is worth, so the first
    /// ones share no row.
    [[nodiscard]] static constexpr std::size_t rowOf(std::uint64_t steps) noexcept {
        if (steps <= 16) {
            return static_cast<std::size_t>(steps > 0 ? steps - 1 : 0);
        }
        return steps <= 24 ? 16 : steps <= 32 ? 17 : steps <= 48 ? 18 : steps <= 64 ? 19 : 20;
    }
    [[nodiscard]] static constexpr std::size_t regionRowOf(std::uint64_t steps) noexcept {
        std::size_t row = 0;
        while (row + 1 < regionRows && steps > (std::uint64_t{1} << row)) {
            ++row;
        }
        return row;
    }
    using Row = std::array<float, knots>;  ///< probabilities that the meshes collide, not falling

    std::string poses;  ///< what it holds for, in words; one line
    RateFormula formula;
    /// Before the first step, by 1 / D^4 of the two whole surfaces in place of a rate. Of the meshes that it was fitted
    /// on, the one that makes it least sure: a hole through a body counts here, and later steps see it.
    Row whole{};
    std::array<Row, stepRows> bySteps{};  ///< while the estimate goes on
    std::array<Row, afterRows>
        afterwards{};  ///< when the exact part that follows has not ended yet; rate: the last one
    /// That the surfaces cross where a contact region says, by the region's rate and its part of the steps.
    std::array<Row, regionRows> regions{};
};

/// Fitted on generated meshes and Zachmann's procedure (see data/README.md); compiled in.
[[nodiscard]] const Calibration& defaultCalibration();

/// P(collide) of two whole surfaces this D^2 apart. Linear between knots, constant beyond the last, like the others.
[[nodiscard]] float probabilityOfWholes(const Calibration& calibration, float squaredDistance) noexcept;
/// P(collide) when `steps` >= 1 steps have left a cut of this rate > 0.
[[nodiscard]] float probabilityAfter(const Calibration& calibration, float rate, std::uint64_t steps) noexcept;
/// P(collide) when the estimate ended with this rate, and `exactSteps` more have found nothing yet.
[[nodiscard]] float probabilityAfterwards(const Calibration& calibration, float rate,
                                          std::uint64_t exactSteps) noexcept;

/// P(the surfaces cross where a contact region says) for a region with this rate > 0 and `steps` >= 1 of the steps.
[[nodiscard]] float probabilityOfRegion(const Calibration& calibration, float rate, std::uint64_t steps) noexcept;

/// Of a knot, 0 to Calibration::knots - 1.
[[nodiscard]] float knotRate(std::size_t knot) noexcept;
/// The least rate whose probability in a row is at least this, and the largest of those whose probability is at most
/// this. Infinity, and -1, if there is none.
[[nodiscard]] float leastRateAt(const Calibration::Row& row, float probability) noexcept;
[[nodiscard]] float mostRateAt(const Calibration::Row& row, float probability) noexcept;

/// As text: what `calibrationFrom` reads. The numbers come back to the last bit.
[[nodiscard]] std::string toText(const Calibration& calibration);
/// @param source names the text in errors
/// @throws Error badFile: of another version, truncated, more than there should be, a number that is none or out of
/// range (probabilities outside [0, 1] or falling), with its line
[[nodiscard]] Calibration calibrationFrom(std::string_view text, const std::string& source);

}  // namespace grapeshot
