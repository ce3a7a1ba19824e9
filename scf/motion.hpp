// How a surface moves within one step: its vertices on straight lines, and the frame they stand in along a line while
// it turns at a constant rate.
#pragma once

#include <Eigen/Core>
#include <span>

#include <grapeshot/core/mesh_view.hpp>
#include <grapeshot/core/pose.hpp>
#include <grapeshot/scf/stretch.hpp>

namespace grapeshot {

/// The motion of a frame, time from 0 to 1: its origin goes straight from `from.translation` along `path`, while it
/// turns about it at a constant rate. What an integrator does with a body whose origin is its centre of mass.
struct RigidMotion {
    Pose from;
    Eigen::Vector3f path = Eigen::Vector3f::Zero();  ///< m
    Eigen::Vector3f turn = Eigen::Vector3f::Zero();  ///< axis times angle, rad; more than one turn is well
};

/// The shortest turn that leads from one to the other: at most half a turn, so a body that spins faster needs its turn
/// given. @pre both rigid
[[nodiscard]] RigidMotion motionBetween(const Pose& from, const Pose& to);

/// @param time 0..1; 0 gives `motion.from` to the byte
[[nodiscard]] Pose poseAt(const RigidMotion& motion, double time);

/// Where a surface is during a step. The spans are read during the query only.
struct SurfaceMotion {
    /// m, in the frame of `frame`, as many as vertices at rest; empty: at rest.
    std::span<const Eigen::Vector3f> before;
    /// Likewise at the end of the step; each vertex goes there on a straight line. Empty: as before, it does not
    /// deform.
    std::span<const Eigen::Vector3f> now;
    RigidMotion frame;
    Stretch stretch;  ///< for both ends of the step: what holds there holds between them
    /// The triangles that the caller has now; if given, they are compared with those the tree was built on.
    std::span<const Triangle> triangles;
};

/// A body that moves as a whole.
[[nodiscard]] inline SurfaceMotion rigidMotion(const RigidMotion& frame = {}) {
    return {{}, {}, frame, Stretch::rigid(), {}};
}

}  // namespace grapeshot
