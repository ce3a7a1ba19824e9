// A watch over estimated answers while a scene runs: a share of them, chosen by a seeded coin, is answered again
// exactly, and says how many of all can have been wrong so far. Holds whatever the scene does.
//
// The derivation and its sources stand in adb/detail/selected_count.hpp.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include <grapeshot/adb/query.hpp>
#include <grapeshot/core/random.hpp>

namespace grapeshot {

struct AuditSettings {
    double share = 0.01;            ///< probability that an estimated answer is re-checked, at first, in (0, 0.5]
    double workShare = 0.03;        ///< of all work, what re-checks may take, in (0, 1]
    double confidence = 0.95;       ///< of both bounds together, at all times; and of `exceeded`; in [0.5, 1)
    double missLimit = 0.01;        ///< where `exceeded` begins, as in a Certificate, in (0, 1)
    double falseAlarmLimit = 0.05;  ///< likewise
};

/// A copyable value without memory of its own: some counts. Saved and restored by copying. The caller keeps the poses
/// that wait for a re-check:
///
///     const Decision answer = query.decide(pose, settings);
///     if (const auto ticket = audit.count(answer, key)) {
///         waiting.push_back({pose, *ticket});
///     }
///     if (!waiting.empty()) {  // after each answer or once a frame: as far as the allowance goes, on from where it
///     was
///         const Budget budget{audit.allowance()};
///         const std::uint64_t before = begun ? exact.work : 0;
///         exact = begun ? check.resume(budget) : check.decide(waiting.front().pose, DecideSettings::exact(), budget);
///         begun = !exact.certain;
///         audit.charge(exact.work - before);
///         if (exact.certain) {
///             audit.record(waiting.front().ticket, exact.collides);
///             waiting.pop_front();
///         }
///     }
///
/// What waits counts as wrong until it is done, so it may wait, and be forgotten, for any reason. When eight more
/// wait because the allowance is too small for the share, a new period begins, with a share halved until it is no more
/// than what has been managed so far (once at least, to a quarter at most); up to seven times. The bounds of the
/// periods are added up.
///
/// A first share of about workShare * workPerPose / exactWorkPerPose, by the pair's certificate, lasts.
///
/// What must hold: each answer has a key of its own (the same key twice is the same coin twice), and neither the
/// answers nor what they are asked about foresee the coins; they may depend on all coins before. An answer that was
/// drawn (answerOf) is counted as it was given. What it says is about all answers counted so far, not about those to
/// come.
class Audit {
  public:
    /// What must be kept of an answer until it is re-checked.
    struct Ticket {
        bool collides = false;  ///< what was answered
        std::uint8_t period = 0;
    };

    /// @throws Error badSetting
    explicit Audit(const AuditSettings& settings = {});

    /// Counts an answer, certain or estimated, and its work; a ticket if it is to be re-checked. Once per answer. What
    /// is no answer (invalidInput) is not counted.
    std::optional<Ticket> count(const Decision& answer, const RandomKey& key) noexcept;

    /// The truth about an answer with a ticket. Once per ticket.
    void record(const Ticket& ticket, bool collides) noexcept;

    /// Work units that a re-check has taken, or a part of one.
    void charge(std::uint64_t work) noexcept { m_checkWork += work; }
    /// Units that may go into re-checks now: the share of the work so far, less what they took.
    [[nodiscard]] std::uint64_t allowance() const noexcept;

    /// The coin as it would fall now: a pure function of the key and the present share.
    [[nodiscard]] bool wants(const RandomKey& key) const noexcept;
    /// The present share: the first one, or a half, a quarter, ... of it.
    [[nodiscard]] double share() const noexcept { return shareOf(m_period); }

    /// Upper bounds, at all times and both together with the confidence: how many of the estimated answers so far were
    /// a no to a collision, a yes to none. Some 10 us a period; ask once a frame.
    [[nodiscard]] std::uint64_t missesAtMost() const noexcept { return wrongAtMost(m_no); }
    [[nodiscard]] std::uint64_t falseAlarmsAtMost() const noexcept { return wrongAtMost(m_yes); }

    /// The same as rates in 0..1, as in a Certificate: misses / colliding and false alarms / clear, of all answers so
    /// far, certain ones included. 0 as long as there was no estimated no, or yes. Twice the time.
    [[nodiscard]] double missBound() const noexcept;
    [[nodiscard]] double falseAlarmBound() const noexcept;

    /// Is one of the rates so far certainly above its limit? False forever with probability >= confidence as long as
    /// both are below. Then answer exactly from here on, and say so. The time of the bounds at most.
    [[nodiscard]] bool exceeded() const noexcept;

    /// Estimated answers of one kind, yes or no, in one period.
    struct Tally {
        std::uint64_t estimated = 0;
        std::uint64_t chosen = 0;   ///< of them, for a re-check
        std::uint64_t checked = 0;  ///< of these, done
        std::uint64_t wrong = 0;    ///< of these
        [[nodiscard]] std::uint64_t waiting() const noexcept { return chosen - checked; }
    };
    static constexpr std::size_t periods = 8;
    /// All answers of one kind.
    struct Answers {
        std::uint64_t certain = 0;
        std::array<Tally, periods> byPeriod{};
        [[nodiscard]] Tally estimated() const noexcept;  ///< summed over the periods
    };
    [[nodiscard]] const Answers& yes() const noexcept { return m_yes; }
    [[nodiscard]] const Answers& no() const noexcept { return m_no; }
    [[nodiscard]] std::uint64_t answerWork() const noexcept { return m_answerWork; }  ///< units, without re-checks
    [[nodiscard]] std::uint64_t checkWork() const noexcept { return m_checkWork; }    ///< units of re-checks
    [[nodiscard]] const AuditSettings& settings() const noexcept { return m_settings; }

  private:
    void beginPeriod() noexcept;
    [[nodiscard]] double shareOf(std::size_t period) const noexcept;
    [[nodiscard]] double confidenceOf(std::size_t period) const noexcept;
    [[nodiscard]] std::uint64_t wrongAtMost(const Answers& answers) const noexcept;
    [[nodiscard]] bool certainlyAbove(const Answers& answers, const Answers& others, double limit) const noexcept;

    AuditSettings m_settings;
    Answers m_yes, m_no;
    std::uint64_t m_answerWork = 0;
    std::uint64_t m_checkWork = 0;
    std::uint64_t m_mostWaiting = 0;                 ///< more, and a new period begins
    std::array<std::uint8_t, periods> m_halvings{};  ///< of the first share, in each period
    std::uint8_t m_period = 0;
};

}  // namespace grapeshot
