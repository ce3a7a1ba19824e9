// Between Bullet's vectors and Eigen's.
#pragma once

#include <btBulletDynamicsCommon.h>

#include <Eigen/Core>

#include <scenes/true_penetration.hpp>

namespace grapeshot::scenes::detail {

inline btVector3 toBullet(const Eigen::Vector3d& v) {
    return {static_cast<btScalar>(v.x()), static_cast<btScalar>(v.y()), static_cast<btScalar>(v.z())};
}

inline Eigen::Vector3d fromBullet(const btVector3& v) {
    return {v.x(), v.y(), v.z()};
}

inline btTransform toBullet(const PoseD& pose) {
    btTransform transform;
    for (int row = 0; row < 3; ++row) {
        transform.getBasis()[row] = toBullet(Eigen::Vector3d(pose.rotation.row(row)));
    }
    transform.setOrigin(toBullet(pose.translation));
    return transform;
}

inline PoseD fromBullet(const btTransform& transform) {
    PoseD pose;
    for (int row = 0; row < 3; ++row) {
        pose.rotation.row(row) = fromBullet(transform.getBasis()[row]).transpose();
    }
    pose.translation = fromBullet(transform.getOrigin());
    return pose;
}

}  // namespace grapeshot::scenes::detail
