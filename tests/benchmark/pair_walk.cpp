#include "pair_walk.hpp"

#include <algorithm>
#include <iterator>
#include <limits>

#include <grapeshot/adb/detail/whole_pair.hpp>

namespace grapeshot::bench {

PairWalk::PairWalk(const Tree& a, const Tree& b)
    : m_cutA(detail::cutCapacity), m_cutB(detail::cutCapacity), m_a(&a), m_b(&b) {
    detail::setTrees(m_descent, a, b);
    m_stack.lendTo(m_descent);
    m_cut.sidesA = m_cutA.data();
    m_cut.sidesB = m_cutB.data();
    m_cut.rates = m_rates;
}

bool PairWalk::start(const Pose& bInA) {
    m_descent.pose = bInA;
    m_descent.depth = 0;
    if (detail::prepare(bInA, m_a->radius, m_b->radius, 0, m_descent.prepared) != detail::PoseVerdict::usable) {
        return false;
    }
    m_squaredDistance = detail::squaredDistanceOfWholes(m_a->whole, m_b->whole, m_descent.prepared);
    detail::startCut(m_cut);
    return true;
}

detail::EstimateEnd PairWalk::estimate(const RateFormula& formula) {
    return detail::toEstimate(m_descent, m_cut, formula, detail::noLimits, std::numeric_limits<std::uint32_t>::max(),
                              1);
}

detail::SidePair PairWalk::likeliest() const {
    const float* const largest = std::max_element(m_cut.rates, m_cut.rates + 16 * m_cut.blocks);
    const auto place = static_cast<std::size_t>(largest - m_cut.rates);
    return detail::sidePair(m_cut.sidesA[place], m_cut.sidesB[place]);
}

int PairWalk::children(detail::SidePair pair, detail::ChildPair (&out)[16]) const {
    return detail::childPairs(m_descent, pair, out);
}

bool PairWalk::descend(std::uint64_t& steps) {
    m_descent.work = 0;
    const bool found = detail::toOverlap(m_descent, unlimited) == detail::DescentEnd::found;
    steps = m_descent.work;
    return found;
}

bool PairWalk::overlaps(detail::SidePair pair) {
    m_descent.depth = 0;
    detail::push(m_descent, pair);
    std::uint64_t steps = 0;
    return descend(steps);
}

bool PairWalk::overlapsBelowCut(std::uint64_t& steps) {
    m_descent.depth = 0;
    const detail::Cut cut = m_cut;  // the walk goes on from it
    const std::vector<detail::Side> sidesA = m_cutA;
    const std::vector<detail::Side> sidesB = m_cutB;
    const std::vector<float> rates(std::begin(m_rates), std::end(m_rates));
    detail::handOver(m_descent, m_cut);
    m_cut = cut;
    std::copy(sidesA.begin(), sidesA.end(), m_cutA.begin());
    std::copy(sidesB.begin(), sidesB.end(), m_cutB.begin());
    std::copy(rates.begin(), rates.end(), m_rates);
    return descend(steps);
}

}  // namespace grapeshot::bench
