#include <grapeshot/scf/motion.hpp>

#include <grapeshot/scf/detail/turning.hpp>

namespace grapeshot {

RigidMotion motionBetween(const Pose& from, const Pose& to) {
    RigidMotion motion;
    motion.from = from;
    motion.path = to.translation - from.translation;
    const Eigen::Matrix3d turned = to.rotation.cast<double>() * from.rotation.cast<double>().transpose();
    motion.turn = detail::axisAngleOf(turned).cast<float>();
    return motion;
}

Pose poseAt(const RigidMotion& motion, double time) {
    Pose pose = motion.from;
    if (time == 0) {
        return pose;
    }
    pose.translation = (motion.from.translation.cast<double>() + time * motion.path.cast<double>()).cast<float>();
    if (!motion.turn.isZero(0)) {
        const Eigen::Matrix3d turned = detail::rotationBy(time * motion.turn.cast<double>());
        pose.rotation = (turned * motion.from.rotation.cast<double>()).cast<float>();
    }
    return pose;
}

}  // namespace grapeshot
