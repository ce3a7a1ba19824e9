// The sides that a keeper remembers, by pairs of cells.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <grapeshot/scf/ball_tree.hpp>
#include <grapeshot/scf/depth.hpp>

namespace grapeshot::detail {

struct KeptSides {
    std::uint64_t key = 0;   ///< cell of A, then of B
    std::uint64_t step = 0;  ///< of its last contact
    ContactSides sides;
    bool isCrossed = false;  ///< in that step
};

/// All that is saved.
struct SideMemory {
    std::vector<KeptSides> kept;  ///< ascending keys
    std::uint64_t step = 0;
    float spacing = 0;  ///< that the cells are of; of another one nothing is known

    /// Null if there is none.
    [[nodiscard]] const KeptSides* find(std::uint64_t key) const;
    /// Takes in what a step has asked for, keys in any order, and forgets what is older than `keepSteps`.
    void merge(std::vector<KeptSides>& asked, std::uint32_t keepSteps);
};

[[nodiscard]] std::vector<std::byte> savedSides(const SideMemory& memory, const BallTree& a, const BallTree& b);
/// @throws Error badFile, topologyChanged
[[nodiscard]] SideMemory loadedSides(std::span<const std::byte> bytes, const BallTree& a, const BallTree& b);

}  // namespace grapeshot::detail
