// A watch over estimated answers while a scene runs: a share of them, chosen by a seeded coin, is answered again
// exactly, and says how many of all can have been wrong so far. Holds whatever the scene does.
//
// The derivation and its sources stand in adb/detail/selected_count.hpp.
#pragma once

#include <cstdint>

#include <grapeshot/adb/query.hpp>
#include <grapeshot/core/random.hpp>

namespace grapeshot {

struct AuditSettings {
    double share = 0.01;            ///< probability that an estimated answer is re-checked, in (0, 0.5]
    double workShare = 0.03;        ///< of all work, what re-checks may take, in (0, 1]
    double confidence = 0.95;       ///< of both bounds together, at all times; and of `exceeded`; in [0.5, 1)
    double missLimit = 0.01;        ///< where `exceeded` begins, as in a Certificate, in (0, 1)
    double falseAlarmLimit = 0.05;  ///< likewise
};

/// A copyable value without memory of its own: a few counts. Saved and restored by copying. For each answer:
///
///     const Decision answer = query.decide(pose, settings);
///     if (audit.count(answer, key)) {              // the coin says: to be re-checked
///         waiting.push_back({pose, answer});       // now or later: what waits counts as wrong until it is done
///     }
///     while (!waiting.empty() && audit.allowance() > 0) {
///         const Decision exact = query.decide(waiting.front().pose, DecideSettings::exact());
///         audit.record(waiting.front().answer, exact.collides, exact.work);
///         waiting.pop_front();
///     }
///
/// If it is done at once, `query.resume({})` does it and only its own part of the work counts.
///
/// What must hold: each answer has a key of its own (the same key twice is the same coin twice), and neither the
/// answers nor what they are asked about foresee the coins. They may depend on all coins before. What it says is about
/// all answers counted so far, not about those to come.
class Audit {
  public:
    /// @throws Error badSetting
    explicit Audit(const AuditSettings& settings = {});

    /// The coin: a pure function of the key.
    [[nodiscard]] bool wants(const RandomKey& key) const noexcept;

    /// Counts an answer, certain or estimated, and its work; true if it is to be re-checked. Once per answer. What is
    /// no answer (invalidInput) is not counted.
    bool count(const Decision& answer, const RandomKey& key) noexcept;

    /// The re-check of an answer for which `count` was true. @param work units that it took, without the estimate's
    void record(const Decision& answer, bool collides, std::uint64_t work) noexcept;

    /// Units that may go into re-checks now: the share of the work counted so far, less what they took. One more
    /// re-check than this is the most by which the share is exceeded.
    [[nodiscard]] std::uint64_t allowance() const noexcept;

    /// Upper bounds, at all times and both together with the confidence: how many of the estimated answers so far were
    /// a no to a collision, a yes to none. Some 10 us; ask once a frame.
    [[nodiscard]] std::uint64_t missesAtMost() const noexcept;
    [[nodiscard]] std::uint64_t falseAlarmsAtMost() const noexcept;

    /// The same as rates in 0..1, as in a Certificate: misses / colliding and false alarms / clear, of all answers so
    /// far, certain ones included. 0 as long as there was no estimated no, or yes. Some 20 us.
    [[nodiscard]] double missBound() const noexcept;
    [[nodiscard]] double falseAlarmBound() const noexcept;

    /// Is one of the rates so far certainly above its limit? False forever with probability >= confidence as long as
    /// both are below. Then answer exactly from here on, and say so. About 2 us.
    [[nodiscard]] bool exceeded() const noexcept;

    /// Answers of one kind, yes or no.
    struct Tally {
        std::uint64_t certain = 0;
        std::uint64_t estimated = 0;
        std::uint64_t chosen = 0;   ///< of the estimated ones, for a re-check
        std::uint64_t checked = 0;  ///< of these, done
        std::uint64_t wrong = 0;    ///< of these
        [[nodiscard]] std::uint64_t waiting() const noexcept { return chosen - checked; }
    };
    [[nodiscard]] const Tally& yes() const noexcept { return m_yes; }
    [[nodiscard]] const Tally& no() const noexcept { return m_no; }
    [[nodiscard]] std::uint64_t answerWork() const noexcept { return m_answerWork; }  ///< units, without re-checks
    [[nodiscard]] std::uint64_t checkWork() const noexcept { return m_checkWork; }    ///< units of re-checks
    [[nodiscard]] const AuditSettings& settings() const noexcept { return m_settings; }

  private:
    [[nodiscard]] std::uint64_t wrongAtMost(const Tally& tally) const noexcept;
    [[nodiscard]] bool certainlyAbove(const Tally& tally, const Tally& others, double limit) const noexcept;

    AuditSettings m_settings;
    Tally m_yes, m_no;
    std::uint64_t m_answerWork = 0;
    std::uint64_t m_checkWork = 0;
};

}  // namespace grapeshot
