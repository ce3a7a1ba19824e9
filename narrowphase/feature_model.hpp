// What stochastic closest features need of a mesh beside its model.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <grapeshot/adb/tree.hpp>
#include <grapeshot/scf/ball_tree.hpp>

namespace grapeshot {

/// Valid for vertices that move, as long as the triangles stay.
struct FeatureModel {
    BallTree balls;

    /// A leaf block of the model's tree, and which lanes of a leaf of `balls` have triangles of it.
    struct Share {
        std::uint32_t block = 0;
        std::uint32_t lanes = 0;
    };
    std::vector<std::uint32_t> shareBegin;  ///< by leaf of `balls`; one more than there are
    std::vector<Share> shares;

    [[nodiscard]] std::span<const Share> sharesOf(std::uint32_t leaf) const {
        return {shares.data() + shareBegin[leaf], shareBegin[leaf + 1] - shareBegin[leaf]};
    }
};

/// @param leafOf the leaf block of a triangle, see MeshModel
/// @throws Error as buildBallTree does
[[nodiscard]] FeatureModel makeFeatureModel(const Tree& tree, std::span<const std::uint32_t> leafOf);

/// Of all its parts, as they are in memory.
[[nodiscard]] std::size_t bytesOf(const FeatureModel& model);

}  // namespace grapeshot
