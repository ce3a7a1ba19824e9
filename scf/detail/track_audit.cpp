// What may have been missed.
#include <grapeshot/scf/detail/track_step.hpp>

#include <algorithm>

namespace grapeshot::detail {
namespace {

constexpr double caution = 0.75;  // what is not finished counts as a hit
constexpr float priceMemory = 0.9F;

}  // namespace

void TrackStep::audit(bool complete) {
    KeyMap& reported = m_scratch.reported;
    reported.clear();
    if (!m_scratch.candidates.empty()) {
        for (const TrackedContact& contact : m_out.contacts) {
            reported.insert(cellKey(m_frontA, m_frontB, contact.pair), 0);
        }
    }
    std::vector<std::uint32_t>& unknown = m_scratch.unknown;
    unknown.clear();
    MissEstimate& miss = m_out.miss;
    for (std::uint32_t i = 0; i < m_scratch.candidates.size(); ++i) {
        const Candidate& candidate = m_scratch.candidates[i];
        if (reported.find(joined(m_frontA.cellAt(candidate.cells.a), m_frontB.cellAt(candidate.cells.b))) != nullptr) {
            ++miss.reported;
        } else if (!candidate.isAhead) {
            unknown.push_back(i);
        }
    }
    miss.unknown = unknown.size();
    // How many is decided before the first is tested, from earlier steps' prices: to stop when the budget ends would
    // prefer the cheap ones.
    const std::uint64_t units = left();
    const double affordable =
        units == unlimited ? static_cast<double>(unknown.size())
                           : caution * static_cast<double>(units) / static_cast<double>(std::max(1.0F, m_testPrice));
    miss.sampled = m_settings.auditShare > 0
                       ? static_cast<std::uint64_t>(std::min(affordable, static_cast<double>(unknown.size())))
                       : 0;
    std::uint64_t spent = 0;
    for (std::size_t i = 0; i < miss.sampled; ++i) {
        std::swap(unknown[i], unknown[i + below(unknown.size() - i)]);
        if (left() == 0) {
            ++miss.open;
            continue;
        }
        const std::uint64_t begin = work();
        const Candidate& candidate = m_scratch.candidates[unknown[i]];
        Clearance clearance = clearanceToFind();
        const SearchEnd end = m_scratch.search.runUntil(
            m_space, candidate.cells, true, [&] { return left() == 0; },
            [&](const PairBatch& batch, int lane) {
                report(batch, lane);
                return false;
            },
            m_usesFront ? &clearance : nullptr);
        if (m_usesFront && end == SearchEnd::exhausted) {
            m_scratch.keptFront.setSlack(candidate.record, clearance.least);
        }
        spent += work() - begin;
        miss.open += end == SearchEnd::limited ? 1 : 0;
        miss.hits += end == SearchEnd::stopped ? 1 : 0;
    }
    miss.reported += miss.hits;
    if (miss.sampled > 0) {
        const float price =
            static_cast<float>(spent) / static_cast<float>(std::max<std::uint64_t>(1, miss.sampled - miss.open));
        m_testPrice = priceMemory * m_testPrice + (1 - priceMemory) * price;
    }
    estimateMissed(miss, complete, static_cast<double>(unit()));
    m_out.certain = complete && m_out.carried == 0 && miss.sampled == miss.unknown && miss.open == 0;
    m_out.stop = m_out.certain ? StopReason::certain : StopReason::budget;
}

}  // namespace grapeshot::detail
