#include "anytime_scenes.hpp"
#include "truth.hpp"
#include "unlike_pairs.hpp"

namespace grapeshot::bench {

std::vector<report::Row> unlikePairsAtSteps(const std::vector<TreeOf>& meshes, int pairs, std::uint64_t seed,
                                            ResumeCheck& check) {
    const UnlikePairs unlike = unlikePairs(meshes, static_cast<std::size_t>(pairs), seed);
    std::vector<Series> all;
    for (std::size_t pair = 0; pair < unlike.pairs.size(); ++pair) {
        const auto& [meshA, meshB] = unlike.pairs[pair];
        const Tree& a = *meshes[meshA].tree;
        const Tree& b = *meshes[meshB].tree;
        const std::vector<Pose> poses = unlike.poses(unlike.of(pair));
        pool(all, {estimates(a, b, poses, exactTruth(a, b, poses).collides, stepBudgets, 0, check)});
    }
    return rowsOf(all.front(), "unlike pairs", std::to_string(meshes.size()) + " meshes", 0);
}

}  // namespace grapeshot::bench
