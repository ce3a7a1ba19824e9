// What finds contact regions: our estimate after so many steps, and what it is measured against.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <grapeshot/adb/crossing.hpp>

#include "interleave.hpp"
#include "region_scoring.hpp"

namespace grapeshot::bench {

/// As in all of the suite; box diagonals are 2 m.
inline constexpr RegionSettings contactRegions{.spacing = 0.1F, .normalCone = 0.5F};

struct ContactMethod {
    std::string name;
    std::uint64_t budget = 0;   ///< of an estimate
    std::size_t triangles = 0;  ///< of a decimated mesh
    std::function<void(const Pose&, Regions&)> find;
    std::function<std::uint64_t()> work;  ///< of the last one
};

/// Two copies of a tree, stopped after so many units; `unlimited` is exact. Trees must outlive it.
[[nodiscard]] ContactMethod estimateMethod(const Tree& tree, std::uint64_t budget);

/// The exact traversal that is stopped, with what it has found by then.
[[nodiscard]] ContactMethod stoppedMethod(const Tree& tree, std::uint64_t budget);

/// Edge collapse to about so many triangles, exact then. The rival that counts.
[[nodiscard]] ContactMethod decimatedMethod(MeshView mesh, std::size_t triangles);

[[nodiscard]] Contender contender(const ContactMethod& method, std::span<const Pose> poses);

}  // namespace grapeshot::bench
