#include <grapeshot/adb/audit.hpp>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>

#include <grapeshot/adb/detail/selected_count.hpp>
#include <grapeshot/core/error.hpp>

namespace grapeshot {
namespace {

/// Of the key's draws, one that nothing else takes.
constexpr std::uint32_t auditDraw = 0xa0d17U;

void require(bool fine, const char* place, double value) {
    if (!fine) {
        throw Error(Fault::badSetting, std::to_string(value), place);
    }
}

/// The rate of `wrong` answers among these and the `right` ones of the same truth.
double rate(std::uint64_t wrong, std::uint64_t right) noexcept {
    return wrong == 0 ? 0 : static_cast<double>(wrong) / (static_cast<double>(wrong) + static_cast<double>(right));
}

}  // namespace

Audit::Audit(const AuditSettings& settings) : m_settings(settings) {
    const auto isRate = [](double value) { return value > 0 && value < 1; };
    require(settings.share > 0 && settings.share <= 0.5, "AuditSettings::share", settings.share);
    require(settings.workShare > 0 && settings.workShare <= 1, "AuditSettings::workShare", settings.workShare);
    require(settings.confidence >= 0.5 && settings.confidence < 1, "AuditSettings::confidence", settings.confidence);
    require(isRate(settings.missLimit), "AuditSettings::missLimit", settings.missLimit);
    require(isRate(settings.falseAlarmLimit), "AuditSettings::falseAlarmLimit", settings.falseAlarmLimit);
}

bool Audit::wants(const RandomKey& key) const noexcept {
    // 53 bits: the share itself, not a neighbour of it, is the coin's probability.
    return static_cast<double>(randomBits(key, auditDraw) >> 11U) * 0x1p-53 < m_settings.share;
}

bool Audit::count(const Decision& answer, const RandomKey& key) noexcept {
    if (answer.stop == StopReason::invalidInput) {
        return false;
    }
    m_answerWork += answer.work;
    Tally& tally = answer.collides ? m_yes : m_no;
    if (answer.certain) {
        ++tally.certain;
        return false;
    }
    ++tally.estimated;
    const bool chosen = wants(key);
    tally.chosen += chosen ? 1U : 0U;
    return chosen;
}

void Audit::record(const Decision& answer, bool collides, std::uint64_t work) noexcept {
    Tally& tally = answer.collides ? m_yes : m_no;
    assert(!answer.certain && tally.checked < tally.chosen);
    ++tally.checked;
    tally.wrong += answer.collides != collides ? 1U : 0U;
    m_checkWork += work;
}

std::uint64_t Audit::allowance() const noexcept {
    // s of all work, re-checks included, is s / (1 - s) of the answers' own.
    const double share = std::min(m_settings.workShare, 0.999);
    const double allowed = share / (1 - share) * static_cast<double>(m_answerWork);
    const auto whole = static_cast<std::uint64_t>(allowed);
    return whole > m_checkWork ? whole - m_checkWork : 0;
}

std::uint64_t Audit::wrongAtMost(const Tally& tally) const noexcept {
    // Two kinds of errors, each with half of what may go wrong. What waits may all be wrong: the bound rises with it.
    const double confidence = 1 - 0.5 * (1 - m_settings.confidence);
    const std::uint64_t foundRight = tally.checked - tally.wrong;
    return detail::mostWithSeen(tally.wrong + tally.waiting(), m_settings.share, confidence,
                                tally.estimated - foundRight);
}

std::uint64_t Audit::missesAtMost() const noexcept {
    return wrongAtMost(m_no);
}

std::uint64_t Audit::falseAlarmsAtMost() const noexcept {
    return wrongAtMost(m_yes);
}

double Audit::missBound() const noexcept {
    return rate(missesAtMost(), m_yes.certain + m_yes.estimated - falseAlarmsAtMost());
}

double Audit::falseAlarmBound() const noexcept {
    return rate(falseAlarmsAtMost(), m_no.certain + m_no.estimated - missesAtMost());
}

/// @param others answers of the other kind: all of them may be right, which is the least rate
bool Audit::certainlyAbove(const Tally& tally, const Tally& others, double limit) const noexcept {
    if (tally.wrong == 0) {
        return false;
    }
    // More than w wrong are above the limit: w / (w + right) <= limit < (w + 1) / (w + 1 + right).
    const auto right = static_cast<double>(others.certain + others.estimated);
    const auto stillWithin = static_cast<std::uint64_t>(std::floor(limit / (1 - limit) * right));
    return detail::moreThan(stillWithin, tally.wrong, m_settings.share, 1 - 0.5 * (1 - m_settings.confidence));
}

bool Audit::exceeded() const noexcept {
    return certainlyAbove(m_no, m_yes, m_settings.missLimit) || certainlyAbove(m_yes, m_no, m_settings.falseAlarmLimit);
}

}  // namespace grapeshot
