#include <grapeshot/adb/detail/pair_walk.hpp>

#include <algorithm>
#include <iterator>
#include <limits>

#include <grapeshot/adb/detail/whole_pair.hpp>

namespace grapeshot::detail {

PairWalk::PairWalk(const Tree& a, const Tree& b) : m_cutA(cutCapacity), m_cutB(cutCapacity), m_a(&a), m_b(&b) {
    setTrees(m_descent, a, b);
    m_stack.lendTo(m_descent);
    m_cut.sidesA = m_cutA.data();
    m_cut.sidesB = m_cutB.data();
    m_cut.rates = m_rates;
}

bool PairWalk::start(const Pose& bInA) {
    m_descent.pose = bInA;
    m_descent.depth = 0;
    if (prepare(bInA, m_a->radius, m_b->radius, 0, m_descent.prepared) != PoseVerdict::usable) {
        return false;
    }
    m_squaredDistance = detail::squaredDistanceOfWholes(m_a->whole, m_b->whole, m_descent.prepared);
    startCut(m_cut);
    return true;
}

EstimateEnd PairWalk::estimate(const RateFormula& formula) {
    return toEstimate(m_descent, m_cut, formula, noLimits, std::numeric_limits<std::uint32_t>::max(), 1);
}

SidePair PairWalk::likeliest() const {
    const float* const largest = std::max_element(m_cut.rates, m_cut.rates + 16 * m_cut.blocks);
    const auto place = static_cast<std::size_t>(largest - m_cut.rates);
    return sidePair(m_cut.sidesA[place], m_cut.sidesB[place]);
}

int PairWalk::children(SidePair pair, ChildPair (&out)[16]) const {
    return childPairs(m_descent, pair, out);
}

std::optional<bool> PairWalk::overlaps(SidePair pair, std::uint64_t units) {
    m_descent.depth = 0;
    push(m_descent, pair);
    const DescentEnd end = toOverlap(m_descent, units);
    return end == DescentEnd::budget ? std::nullopt : std::optional(end == DescentEnd::found);
}

bool PairWalk::overlapsBelowCut(std::uint64_t& steps) {
    m_descent.depth = 0;
    const Cut cut = m_cut;  // the walk goes on from it
    const std::vector<Side> sidesA = m_cutA;
    const std::vector<Side> sidesB = m_cutB;
    const std::vector<float> rates(std::begin(m_rates), std::end(m_rates));
    handOver(m_descent, m_cut);
    m_cut = cut;
    std::copy(sidesA.begin(), sidesA.end(), m_cutA.begin());
    std::copy(sidesB.begin(), sidesB.end(), m_cutB.begin());
    std::copy(rates.begin(), rates.end(), m_rates);
    m_descent.work = 0;
    const bool found = toOverlap(m_descent, unlimited) == DescentEnd::found;
    steps = m_descent.work;
    return found;
}

}  // namespace grapeshot::detail
