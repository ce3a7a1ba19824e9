#include "pair_walk.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace grapeshot::bench {

PairWalk::PairWalk(const Tree& a, const Tree& b)
    : m_cutA(detail::cutCapacity), m_cutB(detail::cutCapacity), m_radiusA(a.radius), m_radiusB(b.radius) {
    detail::setTrees(m_descent, a, b);
    m_stack.lendTo(m_descent);
    m_cut.sidesA = m_cutA.data();
    m_cut.sidesB = m_cutB.data();
    m_cut.rates = m_rates;
}

bool PairWalk::start(const Pose& bInA) {
    m_descent.pose = bInA;
    m_descent.depth = 0;
    m_cut.count = 1;
    m_cut.steps = 0;
    m_cut.rate = 0;
    m_cutA[0] = 0;
    m_cutB[0] = 0;
    return detail::prepare(bInA, m_radiusA, m_radiusB, 0, m_descent.prepared) == detail::PoseVerdict::usable;
}

detail::EstimateEnd PairWalk::estimate(const RateFormula& formula) {
    return detail::toEstimate(m_descent, m_cut, formula, detail::noLimits, std::numeric_limits<std::uint32_t>::max(),
                              1);
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
    std::vector<std::pair<float, std::size_t>> sorted;
    for (std::size_t i = 0; i < m_cut.count; ++i) {
        sorted.emplace_back(m_cut.rates[i], i);
    }
    std::sort(sorted.begin(), sorted.end());
    m_descent.depth = 0;
    for (const auto& [rate, i] : sorted) {
        detail::push(m_descent, detail::sidePair(m_cut.sidesA[i], m_cut.sidesB[i]));
    }
    return descend(steps);
}

}  // namespace grapeshot::bench
