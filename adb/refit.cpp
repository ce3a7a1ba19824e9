#include <algorithm>
#include <cmath>

#include <grapeshot/adb/detail/tree_contents.hpp>
#include <grapeshot/adb/tree_builder.hpp>
#include <grapeshot/core/error.hpp>
#include <grapeshot/core/mesh_report.hpp>

namespace grapeshot {

Sliced refitInSlices(Tree& tree, std::span<const Eigen::Vector3f> vertices) {
    if (vertices.size() != tree.vertices.size()) {
        throw Error(Fault::topologyChanged,
                    std::to_string(vertices.size()) + " vertices, built on " + std::to_string(tree.vertices.size()),
                    "refit");
    }
    const auto check = [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            for (int axis = 0; axis < 3; ++axis) {
                const float x = vertices[i][axis];
                if (!std::isfinite(x)) {
                    throw Error(Fault::notFinite, std::to_string(x), "vertex " + std::to_string(i));
                }
                if (std::abs(x) > largestCoordinate) {
                    throw Error(Fault::tooLarge, std::to_string(x), "vertex " + std::to_string(i));
                }
            }
        }
    };
    co_await inPieces(0, vertices.size(), 64, check);
    const auto copy = [&](std::size_t begin, std::size_t end) {
        std::copy(vertices.begin() + static_cast<std::ptrdiff_t>(begin),
                  vertices.begin() + static_cast<std::ptrdiff_t>(end),
                  tree.vertices.begin() + static_cast<std::ptrdiff_t>(begin));
    };
    co_await inPieces(0, vertices.size(), 128, copy);
    co_await detail::fillContentsInSlices(tree);
}

void refit(Tree& tree, std::span<const Eigen::Vector3f> vertices) {
    refitInSlices(tree, vertices).run();
}

}  // namespace grapeshot
