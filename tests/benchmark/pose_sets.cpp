#include "pose_sets.hpp"

namespace grapeshot::bench {

test::PoseSet grazingSet(const Tree& tree, int count, std::uint64_t seed) {
    test::PoseSet set;
    set.distances = {-0.015, -0.005, -0.0015, 0.0015, 0.005, 0.015};
    const int gaps = static_cast<int>(set.distances.size());
    for (int i = 0; i < gaps; ++i) {
        const std::vector<Pose> poses =
            test::grazingPoses(tree, tree, (count + gaps - 1) / gaps, set.distances[static_cast<std::size_t>(i)],
                               seed + static_cast<std::uint64_t>(i));
        set.poses.insert(set.poses.end(), poses.begin(), poses.end());
        set.distanceIndex.insert(set.distanceIndex.end(), poses.size(), i);
    }
    test::Random random(seed);
    shuffle(set, random);
    return set;
}

}  // namespace grapeshot::bench
