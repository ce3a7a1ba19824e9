#include <grapeshot/narrowphase/feature_model.hpp>

#include <algorithm>

#include <grapeshot/narrowphase/model_builder.hpp>
#include <grapeshot/scf/ball_tree_builder.hpp>

namespace grapeshot {
namespace {

template <class T>
std::size_t bytesOf(const std::vector<T>& values) {
    return values.size() * sizeof(T);
}

std::size_t bytesOf(const IndexLists& lists) {
    return bytesOf(lists.begin) + bytesOf(lists.all);
}

}  // namespace

Sliced makeFeatureModelInSlices(const Tree& tree, std::span<const std::uint32_t> leafOf, FeatureModel& model) {
    co_await buildBallTreeInSlices(tree.mesh(), model.balls);
    model.shareBegin.reserve(model.balls.leaves.size() + 1);
    model.shareBegin.push_back(0);
    model.shares.reserve(tree.triangles.size() / 2);
    const auto share = [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const BallLeaf& leaf = model.balls.leaves[i];
            const auto first = static_cast<std::ptrdiff_t>(model.shares.size());
            for (std::uint32_t lane = 0; lane < leaf.count; ++lane) {
                const std::uint32_t block = leafOf[leaf.triangle[lane]];
                const auto known = std::find_if(model.shares.begin() + first, model.shares.end(),
                                                [&](const FeatureModel::Share& one) { return one.block == block; });
                FeatureModel::Share& one =
                    known != model.shares.end() ? *known : model.shares.emplace_back(FeatureModel::Share{block, 0});
                one.lanes |= 1U << lane;
            }
            model.shareBegin.push_back(static_cast<std::uint32_t>(model.shares.size()));
        }
    };
    co_await inPieces(0, model.balls.leaves.size(), 1, share);
}

FeatureModel makeFeatureModel(const Tree& tree, std::span<const std::uint32_t> leafOf) {
    FeatureModel model;
    makeFeatureModelInSlices(tree, leafOf, model).run();
    return model;
}

std::size_t bytesOf(const FeatureModel& model) {
    const BallTree& balls = model.balls;
    const Surface& surface = balls.surface;
    return bytesOf(surface.rest) + bytesOf(surface.triangles) + bytesOf(surface.ring) + bytesOf(surface.fan) +
           bytesOf(surface.edges) + bytesOf(surface.edgeSquare) + bytesOf(balls.nodes) + bytesOf(balls.restBalls) +
           bytesOf(balls.plainBalls) + bytesOf(balls.leaves) + bytesOf(balls.leafOfTriangle) +
           bytesOf(balls.leafVertices) + bytesOf(model.shareBegin) + bytesOf(model.shares);
}

}  // namespace grapeshot
