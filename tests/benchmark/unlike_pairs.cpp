#include "unlike_pairs.hpp"

#include <algorithm>

#include <support/poses.hpp>

#include "pose_sets.hpp"

namespace grapeshot::bench {

std::vector<std::size_t> UnlikePairs::of(std::size_t pair) const {
    std::vector<std::size_t> result;
    for (std::size_t i = 0; i < questions.size(); ++i) {
        if (questions[i].pair == pair) {
            result.push_back(i);
        }
    }
    return result;
}

std::vector<Pose> UnlikePairs::poses(const std::vector<std::size_t>& of) const {
    std::vector<Pose> result;
    for (const std::size_t i : of) {
        result.push_back(questions[i].pose);
    }
    return result;
}

UnlikePairs unlikePairs(const std::vector<TreeOf>& meshes, std::size_t count, std::uint64_t seed) {
    UnlikePairs result;
    for (std::size_t a = 0; a < meshes.size(); ++a) {
        for (std::size_t b = 0; b < meshes.size(); ++b) {
            if (a != b) {
                result.pairs.emplace_back(a, b);
            }
        }
    }
    const std::size_t perPair = (count + result.pairs.size() - 1) / result.pairs.size();
    const int perDistance = static_cast<int>((perPair + zachmannDistances - 1) / zachmannDistances);
    for (std::size_t i = 0; i < result.pairs.size(); ++i) {
        const auto& [a, b] = result.pairs[i];
        for (const Pose& pose :
             test::zachmannPoses(*meshes[a].tree, *meshes[b].tree, zachmannDistances, perDistance, seed + i).poses) {
            result.questions.push_back({i, pose});
        }
    }
    test::Random random(seed);
    for (std::size_t i = result.questions.size(); i > 1; --i) {
        std::swap(result.questions[i - 1], result.questions[random.bits() % i]);
    }
    result.questions.resize(std::min(count, result.questions.size()));
    return result;
}

}  // namespace grapeshot::bench
