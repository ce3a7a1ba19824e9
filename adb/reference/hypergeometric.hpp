// How likely two sets of filled cells, strewn over the same cells, share at least x of them.
//
// This work is based on:
// Jan Klein, Gabriel Zachmann. ADB-Trees: Controlling the Error of Time-Critical Collision Detection. VMV 2003
// Gabriel Zachmann. Collision Detection as a Fundamental Technology in VR Based Product Engineering. 2007, eq. 8, 9
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace grapeshot::reference {

/// s bins, sA of them hold a blue ball and sB a red one, no bin two of one colour (definition 5). Whole numbers; sA and
/// sB beyond s count as s, s below 1 as 1, negative ones as 0.
struct Bins {
    int s = 1;
    int sA = 0;
    int sB = 0;
    [[nodiscard]] Bins clamped() const;
};

/// P(c = t) for t = 0 .. min(sA, sB): the recurrence outwards from the mode, so that nothing under- or overflows.
[[nodiscard]] std::vector<double> collisionCellDistribution(const Bins& bins);

/// Pr[c >= x], eq. 8. Summed from the far end: 1 minus a sum would lose what is below 1e-16, and with it the order of
/// the queue and the test p > 0.
[[nodiscard]] double atLeast(const Bins& bins, int x);

/// E[1 - (1 - LB)^c], what eq. 9 bounds from below.
[[nodiscard]] double expectedCollision(const Bins& bins, double lowerBound);

/// The paper bounds x "by a small number (e.g., 10)".
inline constexpr int tableLength = 10;
/// Pr[c >= 1] .. Pr[c >= 10].
using Tails = std::array<float, tableLength>;

/// The look-up table of the paper: depends neither on objects nor on the bounding volume.
class TailTable {
  public:
    /// For all s up to `bins`. 64: 48,000 entries, 2 MB, some ms; 512 would be 900 MB.
    explicit TailTable(int bins = 64);
    /// From the table, or by the recurrence where it ends.
    [[nodiscard]] Tails operator()(const Bins& bins) const;
    /// For numbers that are not whole: as if sA and sB were rounded up or down at random, right on average. Rounding
    /// them to 0 would prune. s is rounded to the next whole number, at least 1; so are sA and
    /// sB from 1 on where the table ends, since the recurrence costs as much as all the rest.
    [[nodiscard]] Tails operator()(double s, double sA, double sB) const;

  private:
    [[nodiscard]] std::size_t index(const Bins& bins) const;

    int m_bins;
    std::vector<std::size_t> m_start;  ///< of each s
    std::vector<Tails> m_tails;        ///< sA <= sB: the formula is symmetric
};

/// The one of the default size, made at the first call.
[[nodiscard]] const TailTable& tailTable();

/// max over x <= mostCells of Pr[c >= x] (1 - (1 - LB)^x), eq. 9.
[[nodiscard]] double collisionProbability(const Tails& tails, double lowerBound, int mostCells);

}  // namespace grapeshot::reference
