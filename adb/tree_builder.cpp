#include <grapeshot/adb/detail/binary_tree.hpp>
#include <grapeshot/adb/detail/require_setting.hpp>
#include <grapeshot/adb/detail/wide_tree.hpp>
#include <grapeshot/adb/tree.hpp>
#include <grapeshot/adb/tuning.hpp>
#include <grapeshot/core/error.hpp>

namespace grapeshot {

Tree build(MeshView mesh, const BuildSettings& settings) {
    if (settings.maxLeafTriangles < 1 || settings.maxLeafTriangles > 4) {
        throw Error(Fault::badSetting, std::to_string(settings.maxLeafTriangles) + " is not in 1..4",
                    "BuildSettings::maxLeafTriangles");
    }
    if (settings.bins < 4 || settings.bins > 64) {
        throw Error(Fault::badSetting, std::to_string(settings.bins) + " is not in 4..64", "BuildSettings::bins");
    }
    detail::requireSetting(settings.tuningPoses >= 0 && settings.tuningPoses <= 10'000, "BuildSettings::tuningPoses",
                           settings.tuningPoses);
    Tree tree = detail::treeWithoutNodes(mesh);
    detail::addNodes(detail::sortInTwos(tree, settings), tree);
    tune(tree, settings.tuningPoses);
    return tree;
}

}  // namespace grapeshot
