#include <grapeshot/adb/tree_builder.hpp>

#include <grapeshot/adb/detail/binary_tree.hpp>
#include <grapeshot/adb/detail/require_setting.hpp>
#include <grapeshot/adb/detail/wide_tree.hpp>
#include <grapeshot/adb/tuning.hpp>
#include <grapeshot/core/error.hpp>

namespace grapeshot {

Sliced buildInSlices(MeshView mesh, BuildSettings settings, Tree& tree) {
    if (settings.maxLeafTriangles < 1 || settings.maxLeafTriangles > 4) {
        throw Error(Fault::badSetting, std::to_string(settings.maxLeafTriangles) + " is not in 1..4",
                    "BuildSettings::maxLeafTriangles");
    }
    if (settings.bins < 4 || settings.bins > 64) {
        throw Error(Fault::badSetting, std::to_string(settings.bins) + " is not in 4..64", "BuildSettings::bins");
    }
    detail::requireSetting(settings.tuningPoses >= 0 && settings.tuningPoses <= 10'000, "BuildSettings::tuningPoses",
                           settings.tuningPoses);
    tree = Tree();
    co_await detail::copyMeshInSlices(mesh, tree);
    detail::BinaryTree binary;
    co_await detail::sortInTwosInSlices(tree, settings, binary);
    co_await detail::addNodesInSlices(binary, tree);
    for (int i = 0; i < settings.tuningPoses; ++i) {
        co_yield mostSlicedPiece;
    }
    tune(tree, settings.tuningPoses);
}

Tree build(MeshView mesh, const BuildSettings& settings) {
    Tree tree;
    buildInSlices(mesh, settings, tree).run();
    return tree;
}

}  // namespace grapeshot
