#include "interleave.hpp"

#include <algorithm>
#include <limits>

#include <report/machine.hpp>

namespace grapeshot::bench {

namespace {

/// The answers must be used, or the compiler may leave the questions out.
void use(std::size_t answers) {
    volatile std::size_t sink = answers;
    static_cast<void>(sink);
}

}  // namespace

Contender contender(const Peer& peer, std::span<const Pose> poses) {
    return [count = peer.count, poses](std::size_t begin, std::size_t end) {
        return count(poses.subspan(begin, end - begin));
    };
}

std::vector<Times> interleaved(const std::vector<Contender>& contenders, std::size_t questions, int repetitions) {
    // Long enough that the fastest are not measured on what the one before left in the caches.
    constexpr std::size_t chunk = 2000;
    constexpr std::size_t warmUp = 500;
    std::vector<Times> times(contenders.size());
    std::size_t yes = 0;
    for (int repetition = 0; repetition < repetitions; ++repetition) {
        std::vector<double> sums(contenders.size(), 0);
        for (std::size_t begin = 0; begin < questions; begin += chunk) {
            const std::size_t end = std::min(begin + chunk, questions);
            const std::size_t round = begin / chunk + static_cast<std::size_t>(repetition);
            for (std::size_t turn = 0; turn < contenders.size(); ++turn) {
                // Backwards every other time, so that nobody always comes after the same one.
                const std::size_t place = round % 2 == 0 ? turn : contenders.size() - 1 - turn;
                const std::size_t who = (round / 2 + place) % contenders.size();
                // Not timed: what the one before has left in caches and predictors. Other questions than the next.
                const std::size_t last = begin == 0 ? questions : begin;
                yes += contenders[who](last - std::min(last, warmUp), last);
                const double start = report::threadCpuUs();
                yes += contenders[who](begin, end);
                sums[who] += report::threadCpuUs() - start;
            }
        }
        for (std::size_t who = 0; who < contenders.size(); ++who) {
            times[who].push_back(sums[who] / static_cast<double>(questions));
        }
    }
    use(yes);
    return times;
}

std::vector<double> leastUs(const Contender& contender, std::size_t questions, int repetitions) {
    std::vector<double> least(questions, std::numeric_limits<double>::infinity());
    std::size_t yes = 0;
    for (int repetition = 0; repetition < repetitions; ++repetition) {
        for (std::size_t i = 0; i < questions; ++i) {
            const double start = report::wallUs();
            yes += contender(i, i + 1);
            least[i] = std::min(least[i], report::wallUs() - start);
        }
    }
    use(yes);
    return least;
}

std::vector<double> ratios(const Times& of, const Times& to) {
    std::vector<double> result;
    for (std::size_t i = 0; i < of.size(); ++i) {
        result.push_back(to[i] / of[i]);
    }
    return result;
}

}  // namespace grapeshot::bench
