#include "continuous_fcl.hpp"

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/math/bv/OBBRSS.h>
#include <fcl/narrowphase/continuous_collision.h>

#include <vector>

namespace grapeshot::bench {

struct FclMoving::Data {
    fcl::BVHModel<fcl::OBBRSSd> model;
};

namespace {

fcl::Transform3d transformOf(const Pose& pose) {
    fcl::Transform3d result = fcl::Transform3d::Identity();
    result.linear() = pose.rotation.cast<double>();
    result.translation() = pose.translation.cast<double>();
    return result;
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
    fcl::continuousCollide(&m_data->model, transformOf(from), transformOf(to), &other.m_data->model,
                           transformOf(otherFrom), transformOf(otherTo), request, result);
    return result.is_collide ? std::optional(result.time_of_contact) : std::nullopt;
}

}  // namespace grapeshot::bench
