#include <grapeshot/scf/detail/placing.hpp>

#include <cmath>

#include <grapeshot/scf/detail/surface_input.hpp>

namespace grapeshot::detail {

std::optional<Fault> faultIn(const SurfaceState& state, const Surface& surface) {
    if (!isOfSurface(surface, {state.positions}, state.triangles)) {
        return Fault::topologyChanged;
    }
    if (state.pose && !isRigid(*state.pose)) {
        return Fault::notRigid;
    }
    return isUsable(state.stretch) && isUsable(state.displacement) ? std::nullopt : std::optional(Fault::badSetting);
}

std::optional<Fault> faultIn(const RigidMotion& frame) {
    if (!isRigid(frame.from)) {
        return Fault::notRigid;
    }
    if (!frame.path.allFinite() || !frame.turn.allFinite()) {
        return Fault::notFinite;
    }
    return frame.turn.norm() <= static_cast<float>(mostParts) * largestTurn ? std::nullopt
                                                                            : std::optional(Fault::badSetting);
}

std::optional<Fault> faultIn(const SurfaceMotion& motion, const Surface& surface) {
    if (!isOfSurface(surface, {motion.before, motion.now}, motion.triangles)) {
        return Fault::topologyChanged;
    }
    if (const auto fault = faultIn(motion.frame)) {
        return fault;
    }
    return isUsable(motion.stretch) ? std::nullopt : std::optional(Fault::badSetting);
}

float stretchToUse(const SurfaceMotion& motion, const Surface& surface) {
    // Without positions now they are those before.
    return motion.now.empty() ? stretchToUse(motion.stretch, surface, {motion.before})
                              : stretchToUse(motion.stretch, surface, {motion.before, motion.now});
}

Placed place(const SurfaceState& state, PosedTree& tree, Centers centers) {
    const Surface& surface = tree.tree().surface;
    Placed result;
    result.stretch = stretchToUse(state.stretch, surface, {state.positions});
    if (std::isnan(result.stretch)) {
        result.fault = Fault::notFinite;
        return result;
    }
    const Pose* pose = state.pose ? &*state.pose : nullptr;
    if (!state.positions.empty()) {
        tree.begin(state.positions, pose, result.stretch);
    } else if (centers == Centers::anywhere) {
        tree.beginAtRest(pose);
    } else {
        tree.begin(surface.rest, pose, result.stretch);
    }
    return result;
}

}  // namespace grapeshot::detail
