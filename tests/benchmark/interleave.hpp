// Timing things against each other: on the same questions, piece by piece, taking turns in going first, so that
// whatever else the machine does hits them all alike.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include <report/report.hpp>

#include "peer.hpp"

namespace grapeshot::bench {

/// Answers the questions [begin, end) of a list that all contenders share, and returns how many answers were yes.
using Contender = std::function<std::size_t(std::size_t begin, std::size_t end)>;

[[nodiscard]] Contender contender(const Peer& peer, std::span<const Pose> poses);

/// CPU time of this thread per question, us, one value per repetition.
using Times = std::vector<double>;
[[nodiscard]] std::vector<Times> interleaved(const std::vector<Contender>& contenders, std::size_t questions,
                                             int repetitions);

/// Wall time of every question by itself, us, the least of the repetitions: what the slowest ones take. Reading the
/// clock is in it.
[[nodiscard]] std::vector<double> leastUs(const Contender& contender, std::size_t questions, int repetitions);

/// `to` / `of`, repetition by repetition.
[[nodiscard]] std::vector<double> ratios(const Times& of, const Times& to);

}  // namespace grapeshot::bench
