#include "continuous_fcl.hpp"

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/math/bv/OBBRSS.h>
#include <fcl/math/motion/interp_motion.h>
#include <fcl/narrowphase/continuous_collision.h>

#include <vector>

namespace grapeshot::bench {

struct FclMoving::Data {
    fcl::BVHModel<fcl::OBBRSSd> model;
};

namespace {

/// About the body's origin. That of two transforms alone leaves the point unset, about which it turns.
fcl::InterpMotion<double> motionOf(const Pose& from, const Pose& to) {
    return {from.rotation.cast<double>(), from.translation.cast<double>(), to.rotation.cast<double>(),
            to.translation.cast<double>(), fcl::Vector3d::Zero()};
}

}  // namespace

FclMoving::FclMoving(MeshView mesh) : m_data(std::make_shared<Data>()) {
    std::vector<fcl::Vector3d> points;
    for (const Eigen::Vector3f& vertex : mesh.vertices) {
        points.push_back(vertex.cast<double>());
    }
    std::vector<fcl::Triangle> triangles;
    for (const Triangle& triangle : mesh.triangles) {
        triangles.emplace_back(triangle[0], triangle[1], triangle[2]);
    }
    m_data->model.beginModel();
    m_data->model.addSubModel(points, triangles);
    m_data->model.endModel();
}

std::optional<double> FclMoving::impact(const Pose& from, const Pose& to, const FclMoving& other, const Pose& otherFrom,
                                        const Pose& otherTo, double timeError, FclSolver solver) const {
    constexpr std::size_t mostIterations = 1000;
    const fcl::ContinuousCollisionRequestd request(
        mostIterations, timeError, fcl::CCDM_LINEAR, fcl::GST_LIBCCD,
        solver == FclSolver::substeps ? fcl::CCDC_NAIVE : fcl::CCDC_CONSERVATIVE_ADVANCEMENT);
    fcl::ContinuousCollisionResultd result;
    const fcl::InterpMotion<double> motion = motionOf(from, to);
    const fcl::InterpMotion<double> otherMotion = motionOf(otherFrom, otherTo);
    fcl::continuousCollide(&m_data->model, &motion, &other.m_data->model, &otherMotion, request, result);
    return result.is_collide ? std::optional(result.time_of_contact) : std::nullopt;
}

}  // namespace grapeshot::bench
