#include <cmath>

#include <grapeshot/adb/detail/tree_contents.hpp>
#include <grapeshot/adb/tree.hpp>
#include <grapeshot/core/error.hpp>

namespace grapeshot {

void refit(Tree& tree, std::span<const Eigen::Vector3f> vertices) {
    if (vertices.size() != tree.vertices.size()) {
        throw Error(Fault::topologyChanged,
                    std::to_string(vertices.size()) + " vertices, built on " + std::to_string(tree.vertices.size()),
                    "refit");
    }
    constexpr float largest = 1e15F;  // as requireUsable has it
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        for (int axis = 0; axis < 3; ++axis) {
            const float x = vertices[i][axis];
            if (!std::isfinite(x)) {
                throw Error(Fault::notFinite, std::to_string(x), "vertex " + std::to_string(i));
            }
            if (std::abs(x) > largest) {
                throw Error(Fault::tooLarge, std::to_string(x), "vertex " + std::to_string(i));
            }
        }
    }
    std::copy(vertices.begin(), vertices.end(), tree.vertices.begin());
    detail::fillContents(tree);
}

}  // namespace grapeshot
