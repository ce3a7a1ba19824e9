// This work is based on:
// Miriam Ayer et al. An Empirical Distribution Function for Sampling with Incomplete Information. Ann. Math. Stat.
// 26(4), 1955 (pooling adjacent violators)
#include "table_fit.hpp"

#include <algorithm>
#include <cmath>

namespace grapeshot::bench {
namespace {

/// Samples in a row that share one probability.
struct Block {
    double first, last;  ///< octaves of the rate
    double colliding, count;

    /// Never quite 0 or 1: half a collision and half a miss are added, so a long block of one kind says more than a
    /// short one.
    [[nodiscard]] double probability() const { return (colliding + 0.5) / (count + 1); }
};

std::vector<Block> pooled(const std::vector<std::pair<float, bool>>& seen) {
    std::vector<Block> blocks;
    for (const auto& [rate, collides] : seen) {
        const double octaves = std::log2(double{rate});
        blocks.push_back({octaves, octaves, collides ? 1.0 : 0.0, 1});
        while (blocks.size() > 1) {
            const Block last = blocks.back();
            Block& before = blocks[blocks.size() - 2];
            if (before.colliding / before.count < last.colliding / last.count) {
                break;
            }
            before = {before.first, last.last, before.colliding + last.colliding, before.count + last.count};
            blocks.pop_back();
        }
    }
    return blocks;
}

}  // namespace

Calibration::Row fitRow(std::vector<std::pair<float, bool>> seen) {
    std::sort(seen.begin(), seen.end());
    const std::vector<Block> blocks = pooled(seen);
    Calibration::Row row{};
    std::size_t block = 0;
    double highest = 0;
    for (std::size_t knot = 0; knot < row.size(); ++knot) {
        const double octaves = std::log2(double{knotRate(knot)});
        while (block + 1 < blocks.size() && blocks[block + 1].first <= octaves) {
            ++block;
        }
        double p = blocks[block].probability();
        if (octaves > blocks[block].last && block + 1 < blocks.size()) {
            const Block& next = blocks[block + 1];  // between two blocks: on the line
            const double share = (octaves - blocks[block].last) / (next.first - blocks[block].last);
            p += share * (next.probability() - p);
        }
        highest = std::max(highest, p);
        row[knot] = static_cast<float>(highest);
    }
    return row;
}

}  // namespace grapeshot::bench
