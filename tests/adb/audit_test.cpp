// The audit's bounds at all times, on errors of every temper; and its book-keeping.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <functional>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include <grapeshot/adb/audit.hpp>
#include <grapeshot/adb/detail/selected_count.hpp>
#include <grapeshot/core/error.hpp>
#include <grapeshot/core/rate_bound.hpp>
#include <support/poses.hpp>
#include <support/test_size.hpp>

namespace grapeshot::test {
namespace {

Decision answer(bool collides, bool certain = false, std::uint64_t work = 10) {
    Decision decision;
    decision.collides = collides;
    decision.certain = certain;
    decision.stop = certain ? StopReason::certain : StopReason::probability;
    decision.work = work;
    return decision;
}

/// What an adversary knows before the next answer.
struct Past {
    int step = 0;
    std::uint64_t errors = 0;
    std::uint64_t seen = 0;  ///< errors that a re-check found
    bool lastWasChosen = false;
};
/// P(the next answer is wrong).
using Temper = std::function<double(const Past&)>;

struct NamedTemper {
    const char* name;
    Temper rate;
};

/// From tame to malicious. The last ones look at what the audit has found so far.
std::vector<NamedTemper> tempers() {
    return {
        {"none", [](const Past&) { return 0.0; }},
        {"even", [](const Past&) { return 0.01; }},
        {"always wrong", [](const Past&) { return 1.0; }},
        {"drifting", [](const Past& past) { return 0.2 * past.step / (past.step + 2000.0); }},
        {"bursts", [](const Past& past) { return past.step % 1000 < 60 ? 0.9 : 0.0; }},
        {"one burst, late", [](const Past& past) { return past.step > 2000 && past.step < 2400 ? 1.0 : 0.0; }},
        {"until it is seen", [](const Past& past) { return past.seen == 0 ? 1.0 : 0.0; }},
        {"while it is lucky",
         [](const Past& past) { return double(past.seen) < 0.1 * double(past.errors) - 5 ? 1.0 : 0.05; }},
        {"while it is unlucky",
         [](const Past& past) { return double(past.seen) >= 0.1 * double(past.errors) ? 1.0 : 0.02; }},
        {"after a coin", [](const Past& past) { return past.lastWasChosen ? 0.0 : 0.3; }},
    };
}

struct Outcome {
    bool held = true;
    bool alarmed = false;
    double lastBound = 1;
    double lastRate = 0;
};

/// One run: half of the answers are certain; of the estimated ones a third are yes. Errors of both kinds by the temper.
Outcome run(const Temper& temper, std::uint64_t seed, int steps, const AuditSettings& settings, int delay) {
    Audit audit(settings);
    Random random(seed);
    Outcome outcome;
    Past past[2];
    std::uint64_t truths[2] = {0, 0};  // clear, colliding
    std::vector<std::pair<Audit::Ticket, bool>> waiting;
    for (int step = 0; step < steps; ++step) {
        const RandomKey key{.seed = seed, .pair = 7, .step = static_cast<std::uint64_t>(step)};
        const bool certain = random.unit() < 0.5;
        const bool yes = random.unit() < 1.0 / 3;
        Past& kind = past[yes ? 1 : 0];
        kind.step = step;
        const bool wrong = !certain && random.unit() < temper(kind);
        const bool truth = yes != wrong;
        ++truths[truth ? 1 : 0];
        kind.errors += wrong ? 1 : 0;
        const std::optional<Audit::Ticket> chosen = audit.count(answer(yes, certain), key);
        if (!certain) {
            kind.lastWasChosen = chosen.has_value();
        }
        if (chosen) {
            waiting.emplace_back(*chosen, truth);
            kind.seen += wrong ? 1 : 0;
        }
        if (static_cast<int>(waiting.size()) > delay) {
            audit.record(waiting.front().first, waiting.front().second);
            waiting.erase(waiting.begin());
        }
        // Between these times the bounds do not come closer to the truth.
        if (wrong || chosen || step + 1 == steps) {
            outcome.held = outcome.held && (yes ? audit.falseAlarmsAtMost() : audit.missesAtMost()) >= kind.errors;
            if (outcome.held && (step % 16 == 0 || step + 1 == steps)) {
                const auto rate = [](std::uint64_t errors, std::uint64_t all) {
                    return all > 0 ? static_cast<double>(errors) / static_cast<double>(all) : 0;
                };
                outcome.lastRate = rate(past[0].errors, truths[1]);
                outcome.held =
                    audit.missBound() >= outcome.lastRate && audit.falseAlarmBound() >= rate(past[1].errors, truths[0]);
            }
            outcome.alarmed = outcome.alarmed || audit.exceeded();
        }
    }
    outcome.lastBound = audit.missBound();
    return outcome;
}

TEST(Audit, HoldsAtAllTimesWhateverTheErrorsDo) {
    const std::size_t runs = sampleSize(25, 600);
    const int steps = static_cast<int>(sampleSize(3000, 6000));
    for (const NamedTemper& temper : tempers()) {
        SCOPED_TRACE(temper.name);
        for (const int delay : {0, 5, 30}) {
            std::uint64_t held = 0;
            for (std::size_t i = 0; i < runs; ++i) {
                const AuditSettings settings{.share = 0.1};
                held += run(temper.rate, 1000 * i + 17, steps, settings, delay).held ? 1 : 0;
            }
            // Not significantly below 95 %: with 99.9 % confidence in each of the thirty tests.
            EXPECT_GE(upperRate(held, runs, 0.999), 0.95) << held << " of " << runs;
        }
    }
}

TEST(Audit, NarrowsDown) {
    // One in a hundred answers is missed; after many the bound is near that.
    const Temper even = [](const Past&) { return 0.01; };
    double before = 1;
    for (const int steps : {1000, 10'000, 100'000}) {
        const Outcome outcome = run(even, 5, steps, {.share = 0.1}, 0);
        EXPECT_LT(outcome.lastBound, before);
        before = outcome.lastBound;
        if (steps == 100'000) {
            EXPECT_LT(outcome.lastBound, 1.8 * outcome.lastRate);
        }
    }
    // Nothing found yet: fewer than 5.5 / share, as long as it may be.
    Audit audit({.share = 0.01});
    for (std::uint64_t i = 0; i < 100'000; ++i) {
        if (const auto ticket = audit.count(answer(false), {.seed = 3, .pair = 1, .step = i})) {
            audit.record(*ticket, false);
        }
    }
    EXPECT_LE(audit.missesAtMost(), 550U);
    EXPECT_NEAR(static_cast<double>(audit.no().estimated().chosen), 1000, 150);
    EXPECT_EQ(audit.share(), 0.01);
}

TEST(Audit, SoundsTheAlarmWhenItMustAndSeldomElse) {
    const std::size_t runs = sampleSize(40, 600);
    std::uint64_t needless = 0;
    std::uint64_t needed = 0;
    for (std::size_t i = 0; i < runs; ++i) {
        // Estimated no, one error in 600: about one miss in two hundred colliding, half the limit; and thirty times
        // that.
        needless += run([](const Past&) { return 0.0025; }, i, 4000, {.share = 0.1}, 0).alarmed ? 1 : 0;
        needed += run([](const Past&) { return 0.1; }, i, 4000, {.share = 0.1}, 0).alarmed ? 1 : 0;
    }
    EXPECT_LE(lowerRate(needless, runs, 0.999), 0.05);
    EXPECT_GE(needed, runs * 95 / 100);
}

TEST(Audit, WhatWaitsCountsAsWrong) {
    Audit audit({.share = 0.25});
    std::vector<Audit::Ticket> waiting;
    std::uint64_t i = 0;
    for (; waiting.size() < 8; ++i) {
        if (const auto ticket = audit.count(answer(false), {.seed = 8, .pair = 0, .step = i})) {
            waiting.push_back(*ticket);
        }
    }
    EXPECT_EQ(audit.no().estimated().waiting(), 8U);
    EXPECT_EQ(audit.missesAtMost(), i);  // a quarter was chosen, so all may be wrong
    std::uint64_t before = audit.missesAtMost();
    for (const Audit::Ticket& ticket : waiting) {
        audit.record(ticket, false);
        EXPECT_LE(audit.missesAtMost(), before);
        before = audit.missesAtMost();
    }
    EXPECT_LT(before, 22U);
    EXPECT_EQ(audit.no().estimated().waiting(), 0U);
    EXPECT_EQ(audit.no().estimated().wrong, 0U);
}

TEST(Audit, LooksLessOftenWhenTooManyWait) {
    Audit audit({.share = 0.5});
    std::uint64_t chosen = 0;
    for (std::uint64_t i = 0; i < 2'000'000; ++i) {
        const double share = audit.share();
        const bool wanted = audit.wants({.seed = 2, .pair = 1, .step = i});
        const auto ticket = audit.count(answer(true), {.seed = 2, .pair = 1, .step = i});
        EXPECT_EQ(ticket.has_value(), wanted);
        chosen += ticket ? 1 : 0;
        if (audit.share() != share) {
            EXPECT_EQ(audit.share(), share / 4);  // nothing was managed
            EXPECT_EQ(chosen % 8, 1U);
        }
    }
    EXPECT_EQ(audit.share(), 0.5 / 16384);
    EXPECT_EQ(audit.falseAlarmsAtMost(), 2'000'000U);  // nobody has looked
    EXPECT_FALSE(audit.exceeded());
}

TEST(Audit, LooksAsOftenAsIsManaged) {
    // One in a hundred can be done: the share settles below that, and nothing waits for long.
    Audit audit({.share = 0.1});
    std::deque<Audit::Ticket> waiting;
    for (std::uint64_t i = 0; i < 100'000; ++i) {
        if (const auto ticket = audit.count(answer(false), {.seed = 6, .pair = 1, .step = i})) {
            waiting.push_back(*ticket);
        }
        if (i % 100 == 0 && !waiting.empty()) {
            audit.record(waiting.front(), false);
            waiting.pop_front();
        }
    }
    EXPECT_LE(audit.share(), 0.01);
    EXPECT_GE(audit.share(), 0.002);
    EXPECT_LE(waiting.size(), 4U);
    EXPECT_LT(audit.missesAtMost(), 5'000U);
}

TEST(Audit, CountsOnlyAnswersAndTheirWork) {
    Audit audit({.share = 0.5, .workShare = 0.03});
    EXPECT_EQ(audit.missBound(), 0);
    EXPECT_EQ(audit.allowance(), 0U);
    EXPECT_FALSE(audit.count(Decision(), {.step = 1}));
    EXPECT_EQ(audit.yes().estimated().estimated + audit.no().estimated().estimated, 0U);
    for (std::uint64_t i = 0; i < 100; ++i) {
        EXPECT_FALSE(audit.count(answer(i % 2 == 0, true, 97), {.step = i}));
    }
    EXPECT_EQ(audit.yes().certain, 50U);
    EXPECT_EQ(audit.no().certain, 50U);
    EXPECT_EQ(audit.answerWork(), 9700U);
    EXPECT_EQ(audit.allowance(), 300U);  // 3 % of 10,000
    EXPECT_FALSE(audit.exceeded());
    EXPECT_EQ(audit.missBound(), 0);  // nothing was estimated
    audit.charge(290);
    EXPECT_EQ(audit.allowance(), 10U);
    EXPECT_EQ(audit.checkWork(), 290U);
    const Audit copy = audit;
    EXPECT_EQ(copy.allowance(), audit.allowance());
}

TEST(Audit, ChoosesTheShareByTheKey) {
    const Audit audit({.share = 0.01});
    std::uint64_t wanted = 0;
    for (std::uint64_t pair = 0; pair < 100; ++pair) {
        for (std::uint64_t step = 0; step < 1000; ++step) {
            const RandomKey key{.seed = 4, .pair = pair, .step = step};
            wanted += audit.wants(key) ? 1U : 0U;
            EXPECT_EQ(audit.wants(key), Audit({.share = 0.01, .workShare = 1}).wants(key));
        }
    }
    EXPECT_GE(upperRate(wanted, 100'000, 0.999), 0.01);
    EXPECT_LE(lowerRate(wanted, 100'000, 0.999), 0.01);
}

TEST(Audit, RefusesBadSettings) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const auto expectBad = [](const AuditSettings& settings, const char* place) {
        try {
            const Audit audit(settings);
            ADD_FAILURE() << place;
        } catch (const Error& error) {
            EXPECT_EQ(error.fault(), Fault::badSetting);
            EXPECT_EQ(error.place(), place);
        }
    };
    for (const double bad : {0.0, 0.51, nan}) {
        expectBad({.share = bad}, "AuditSettings::share");
    }
    for (const double bad : {0.0, 1.01, nan}) {
        expectBad({.workShare = bad}, "AuditSettings::workShare");
    }
    for (const double bad : {0.4, 1.0, nan}) {
        expectBad({.confidence = bad}, "AuditSettings::confidence");
    }
    for (const double bad : {0.0, 1.0, nan}) {
        expectBad({.missLimit = bad}, "AuditSettings::missLimit");
        expectBad({.falseAlarmLimit = bad}, "AuditSettings::falseAlarmLimit");
    }
}

TEST(SelectedCount, IsAMartingaleInTheErrors) {
    // The mean over the next coin is the value before: to the last digits, anywhere.
    for (const double share : {0.003, 0.01, 0.3}) {
        for (const std::uint64_t total : {0U, 1U, 30U, 2000U}) {
            for (std::uint64_t seen = 0; seen <= std::min<std::uint64_t>(total, 40); seen += 3) {
                for (const auto logValue : {&detail::logTooFewSeen, &detail::logTooManySeen}) {
                    const double now = logValue(total, seen, share);
                    const double next = share * std::exp(logValue(total + 1, seen + 1, share) - now) +
                                        (1 - share) * std::exp(logValue(total + 1, seen, share) - now);
                    EXPECT_NEAR(next, 1, 1e-9) << share << ": " << seen << " of " << total;
                }
            }
        }
    }
    EXPECT_NEAR(detail::logTooFewSeen(0, 0, 0.01), 0, 1e-12);
    EXPECT_NEAR(detail::logTooManySeen(0, 0, 0.01), 0, 1e-12);
}

TEST(SelectedCount, FindsTheEdge) {
    for (const std::uint64_t seen : {0U, 1U, 10U, 1000U}) {
        const std::uint64_t most = detail::mostWithSeen(seen, 0.01, 0.975, 1'000'000'000);
        EXPECT_LT(detail::logTooFewSeen(most, seen, 0.01), std::log(40.0));
        EXPECT_GE(detail::logTooFewSeen(most + 1, seen, 0.01), std::log(40.0));
        EXPECT_EQ(detail::mostWithSeen(seen, 0.01, 0.975, most - 1), most - 1);
        const std::uint64_t fewest = detail::fewestWithSeen(seen, 0.01, 0.975);
        EXPECT_LT(detail::logTooManySeen(fewest, seen, 0.01), std::log(40.0));
        EXPECT_LE(fewest, 100 * seen);
        if (fewest > seen) {
            EXPECT_GE(detail::logTooManySeen(fewest - 1, seen, 0.01), std::log(40.0));
        }
    }
    EXPECT_GT(detail::fewestWithSeen(10, 0.01, 0.975), 100U);
    EXPECT_EQ(detail::fewestWithSeen(0, 0.01, 0.975), 0U);
}

}  // namespace
}  // namespace grapeshot::test
