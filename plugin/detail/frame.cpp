#include <grapeshot/plugin/detail/frame.hpp>

#include <algorithm>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

namespace {

constexpr int mainIsGone = 16;  // dispatches of others

}  // namespace

void Frame::start(const Budget& budget) {
    ++m_number;
    m_budget = budget;
    if (m_budget.time != never) {
        m_startTime = timeOf(m_budget);
    }
    m_spent = m_mandatory = m_building = 0;
    m_dispatches = m_mainDispatches = 0;
    m_expected = 1;
}

void Frame::begin(int dispatches, const Budget& budget) {
    m_explicit = true;
    start(budget);
    m_expected = std::max(1, dispatches);
}

bool Frame::enterDispatch(const void* cache, const Budget& budget) {
    if (m_main == nullptr) {
        m_main = cache;
    }
    m_sinceMain = cache == m_main ? 0 : m_sinceMain + 1;
    if (m_sinceMain > mainIsGone) {
        m_main = cache;
        m_sinceMain = 0;
    }
    m_inMain = cache == m_main;
    const bool begins = !m_explicit && m_inMain;
    if (begins) {
        start(budget);
    }
    if (m_inMain) {
        m_lastLate = m_late;
        m_lastLater = m_later;
        m_late = m_later = {};
        ++m_mainDispatches;
    }
    ++m_dispatches;
    return begins;
}

std::uint64_t Frame::left() const {
    return m_budget.work == unlimited ? unlimited : m_budget.work - std::min(m_budget.work, m_spent);
}

std::uint64_t Frame::dispatchShare() const {
    const std::uint64_t rest = left();
    if (rest == unlimited || !m_inMain) {
        return rest;
    }
    const auto after = static_cast<std::uint64_t>(std::max(0, m_expected - m_mainDispatches));
    const std::uint64_t mine = rest / (after + 1);
    // Their mandatory slices for certain, and up to a quarter for what they want beyond.
    const std::uint64_t slices = m_lastLate.mandatory + m_lastLater.mandatory;
    const std::uint64_t wanted = m_lastLate.work + m_lastLater.work;
    const std::uint64_t kept = std::max(slices, std::min(wanted, mine / 4));
    return mine - std::min(mine, kept);
}

Budget Frame::latecomerSlice(std::uint64_t mandatory) const {
    // As many are still to come as in the last dispatch.
    const std::uint64_t toCome = m_lastLate.count > m_late.count ? m_lastLate.count - m_late.count : 1;
    Budget slice;
    slice.clock = m_budget.clock;
    if (left() != unlimited) {
        slice.work = std::max(mandatory, left() / toCome);
    }
    if (m_budget.time != never) {
        const std::chrono::nanoseconds time = timeLeft() / static_cast<std::int64_t>(toCome);
        if (time > std::chrono::nanoseconds(0)) {
            slice.time = time;
        } else {
            slice.work = mandatory;
        }
    }
    return slice;
}

void Frame::payDispatch(std::uint64_t work, std::uint64_t mandatory) {
    m_spent += work;
    m_mandatory += mandatory;
    if (!m_inMain) {
        m_later.work += work;
        m_later.mandatory += mandatory;
    }
}

void Frame::payBuilding(std::uint64_t work, std::uint64_t mandatory) {
    m_spent += work;
    m_building += work;
    m_mandatory += mandatory;
}

void Frame::payLatecomer(std::uint64_t work, std::uint64_t mandatory) {
    m_spent += work;
    m_mandatory += mandatory;
    Tally& tally = m_inMain ? m_late : m_later;
    tally.work += work;
    tally.mandatory += mandatory;
    tally.count += m_inMain ? 1 : 0;
}

std::chrono::nanoseconds Frame::timeLeft() const {
    if (m_budget.time == never) {
        return never;
    }
    return std::max(std::chrono::nanoseconds(0), m_budget.time - (timeOf(m_budget) - m_startTime));
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
