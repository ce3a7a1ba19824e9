// A mesh that moves in itself: what a refit is for.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace grapeshot::bench {

/// Twisted by a radian from end to end about its longest axis and bent by a tenth of its length: every vertex moves,
/// neighbours alike.
[[nodiscard]] std::vector<Eigen::Vector3f> twisted(std::span<const Eigen::Vector3f> vertices);

}  // namespace grapeshot::bench
