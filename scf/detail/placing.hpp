// What a step is told of a surface is looked at, and a tree put where it says.
#pragma once

#include <optional>

#include <grapeshot/core/error.hpp>
#include <grapeshot/scf/detail/posed_tree.hpp>
#include <grapeshot/scf/motion.hpp>
#include <grapeshot/scf/surface_state.hpp>

namespace grapeshot::detail {

/// rad, for each part of a step: the balls grow by its square / 8 of their distance from the origin.
inline constexpr float largestTurn = 0.25F;
inline constexpr int mostParts = 4096;

/// topologyChanged, notFinite, notRigid or badSetting, if anything.
[[nodiscard]] std::optional<Fault> faultIn(const SurfaceState& state, const Surface& surface);

[[nodiscard]] std::optional<Fault> faultIn(const RigidMotion& frame);
[[nodiscard]] std::optional<Fault> faultIn(const SurfaceMotion& motion, const Surface& surface);

/// For both ends of the step, see surface_input.hpp.
[[nodiscard]] float stretchToUse(const SurfaceMotion& motion, const Surface& surface);

struct Placed {
    float stretch = 1;  ///< that the balls were made with; 0 if they were fitted
    std::optional<Fault> fault;
};
/// Where the balls' centres may be.
enum class Centers {
    anywhere,  ///< of a body at rest: smaller balls
    vertices,
};
/// @pre nothing is wrong with the state
Placed place(const SurfaceState& state, PosedTree& tree, Centers centers = Centers::anywhere);

}  // namespace grapeshot::detail
