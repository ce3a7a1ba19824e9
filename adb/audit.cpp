#include <grapeshot/adb/audit.hpp>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>

#include <grapeshot/adb/detail/require_setting.hpp>
#include <grapeshot/adb/detail/selected_count.hpp>

namespace grapeshot {

using detail::requireSetting;

namespace {

/// Of the key's draws, one that nothing else takes.
constexpr std::uint32_t auditDraw = 0xa0d17U;
/// When so many more wait than when the last period began, another one begins.
constexpr std::uint64_t waitingPerPeriod = 8;

std::uint64_t all(const Audit::Answers& answers) noexcept {
    return answers.certain + answers.estimated().estimated;
}

/// The rate of `wrong` answers among these and the `right` ones of the same truth.
double rate(std::uint64_t wrong, std::uint64_t right) noexcept {
    return wrong == 0 ? 0 : static_cast<double>(wrong) / (static_cast<double>(wrong) + static_cast<double>(right));
}

}  // namespace

Audit::Audit(const AuditSettings& settings) : m_settings(settings), m_mostWaiting(waitingPerPeriod) {
    const auto isRate = [](double value) { return value > 0 && value < 1; };
    requireSetting(settings.share > 0 && settings.share <= 0.5, "AuditSettings::share", settings.share);
    requireSetting(settings.workShare > 0 && settings.workShare <= 1, "AuditSettings::workShare", settings.workShare);
    requireSetting(settings.confidence >= 0.5 && settings.confidence < 1, "AuditSettings::confidence",
                   settings.confidence);
    requireSetting(isRate(settings.missLimit), "AuditSettings::missLimit", settings.missLimit);
    requireSetting(isRate(settings.falseAlarmLimit), "AuditSettings::falseAlarmLimit", settings.falseAlarmLimit);
}

Audit::Tally Audit::Answers::estimated() const noexcept {
    Tally sum;
    for (const Tally& tally : byPeriod) {
        sum.estimated += tally.estimated;
        sum.chosen += tally.chosen;
        sum.checked += tally.checked;
        sum.wrong += tally.wrong;
    }
    return sum;
}

double Audit::shareOf(std::size_t period) const noexcept {
    return std::ldexp(m_settings.share, -static_cast<int>(m_halvings[period]));
}

/// Half of what may go wrong for each kind of errors; of that a half for the first period, a quarter for the second,
/// ...
double Audit::confidenceOf(std::size_t period) const noexcept {
    return 1 - std::ldexp(1 - m_settings.confidence, -2 - static_cast<int>(period));
}

void Audit::beginPeriod() noexcept {
    const Tally yes = m_yes.estimated();
    const Tally no = m_no.estimated();
    const double managed =
        static_cast<double>(yes.checked + no.checked) / static_cast<double>(yes.estimated + no.estimated);
    const double wanted = std::max(managed, share() / 4);
    std::uint8_t halvings = m_halvings[m_period];
    do {
        ++halvings;
    } while (std::ldexp(m_settings.share, -static_cast<int>(halvings)) > wanted);
    ++m_period;
    m_halvings[m_period] = halvings;
    m_mostWaiting += waitingPerPeriod;
}

bool Audit::wants(const RandomKey& key) const noexcept {
    // 53 bits: the share itself, not a neighbour of it, is the coin's probability.
    return static_cast<double>(randomBits(key, auditDraw) >> 11U) * 0x1p-53 < share();
}

std::optional<Audit::Ticket> Audit::count(const Decision& answer, const RandomKey& key) noexcept {
    if (answer.stop == StopReason::invalidInput) {
        return std::nullopt;
    }
    m_answerWork += answer.work;
    Answers& answers = answer.collides ? m_yes : m_no;
    if (answer.certain) {
        ++answers.certain;
        return std::nullopt;
    }
    Tally& tally = answers.byPeriod[m_period];
    ++tally.estimated;
    if (!wants(key)) {
        return std::nullopt;
    }
    ++tally.chosen;
    const Ticket ticket{answer.collides, m_period};
    // From the next answer on: each share is fixed before the coin that it belongs to.
    if (m_yes.estimated().waiting() + m_no.estimated().waiting() > m_mostWaiting && m_period + 1U < periods) {
        beginPeriod();
    }
    return ticket;
}

void Audit::record(const Ticket& ticket, bool collides) noexcept {
    Tally& tally = (ticket.collides ? m_yes : m_no).byPeriod[ticket.period];
    assert(tally.checked < tally.chosen);
    ++tally.checked;
    tally.wrong += ticket.collides != collides ? 1U : 0U;
}

std::uint64_t Audit::allowance() const noexcept {
    // s of all work, re-checks included, is s / (1 - s) of the answers' own.
    const double share = std::min(m_settings.workShare, 0.999);
    const auto allowed = static_cast<std::uint64_t>(share / (1 - share) * static_cast<double>(m_answerWork));
    return allowed > m_checkWork ? allowed - m_checkWork : 0;
}

std::uint64_t Audit::wrongAtMost(const Answers& answers) const noexcept {
    std::uint64_t most = 0;
    for (std::size_t period = 0; period <= m_period; ++period) {
        // What waits may all be wrong: the bound rises with it.
        const Tally& tally = answers.byPeriod[period];
        most += detail::mostWithSeen(tally.wrong + tally.waiting(), shareOf(period), confidenceOf(period),
                                     tally.estimated - (tally.checked - tally.wrong));
    }
    return most;
}

double Audit::missBound() const noexcept {
    return rate(missesAtMost(), all(m_yes) - falseAlarmsAtMost());
}

double Audit::falseAlarmBound() const noexcept {
    return rate(falseAlarmsAtMost(), all(m_no) - missesAtMost());
}

/// @param others answers of the other kind: all of them may be right, which makes the rate least
bool Audit::certainlyAbove(const Answers& answers, const Answers& others, double limit) const noexcept {
    std::uint64_t fewest = 0;
    for (std::size_t period = 0; period <= m_period; ++period) {
        const Tally& tally = answers.byPeriod[period];
        fewest += tally.wrong == 0 ? 0 : detail::fewestWithSeen(tally.wrong, shareOf(period), confidenceOf(period));
    }
    return rate(fewest, all(others)) > limit;
}

bool Audit::exceeded() const noexcept {
    return certainlyAbove(m_no, m_yes, m_settings.missLimit) || certainlyAbove(m_yes, m_no, m_settings.falseAlarmLimit);
}

}  // namespace grapeshot
