#include "pair_cases.hpp"

#include <support/poses.hpp>

namespace grapeshot::test {

std::vector<PairCase> pairCases(const ThreeMeshes& meshes, int distances, int perDistance, std::uint64_t seed) {
    std::vector<PairCase> out;
    for (const auto& [first, second] :
         {std::pair{&meshes.bumpy, &meshes.bumpy}, {&meshes.knot, &meshes.gear}, {&meshes.gear, &meshes.knot}}) {
        PairCase& added = out.emplace_back(
            PairCase{build(scenes::normalised(*first).view()), build(scenes::normalised(*second).view()), {}});
        added.poses = zachmannPoses(added.a, added.b, distances, perDistance, seed).poses;
    }
    return out;
}

Tree moved(const Tree& tree, const Pose& frame) {
    std::vector<Eigen::Vector3f> vertices;
    for (const Eigen::Vector3f& vertex : tree.vertices) {
        vertices.push_back(apply(frame, vertex));
    }
    return build({vertices, tree.triangles});
}

bool same(const Decision& a, const Decision& b) {
    return a.collides == b.collides && a.certain == b.certain && a.stop == b.stop && a.work == b.work &&
           a.witness == b.witness && a.probability == b.probability;
}

}  // namespace grapeshot::test
