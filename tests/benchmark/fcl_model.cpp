#include "fcl_model.hpp"

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/math/bv/OBBRSS.h>
#include <fcl/math/motion/interp_motion.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/continuous_collision.h>

#include <stdexcept>
#include <vector>

namespace grapeshot::bench {

struct FclPoints::Data {
    std::vector<fcl::Vector3d> list;
};

struct FclTriangles::Data {
    std::vector<fcl::Triangle> list;
};

struct FclModel::Data {
    fcl::BVHModel<fcl::OBBRSSd> model;
};

namespace {

/// About the body's origin. That of two transforms alone leaves the point unset, about which it turns.
fcl::InterpMotion<double> motionOf(const Pose& from, const Pose& to) {
    return {from.rotation.cast<double>(), from.translation.cast<double>(), to.rotation.cast<double>(),
            to.translation.cast<double>(), fcl::Vector3d::Zero()};
}

}  // namespace

FclPoints::FclPoints(std::span<const Eigen::Vector3f> points) {
    const auto data = std::make_shared<Data>();
    data->list.reserve(points.size());
    for (const Eigen::Vector3f& point : points) {
        data->list.push_back(point.cast<double>());
    }
    m_data = data;
}

FclTriangles::FclTriangles(std::span<const Triangle> triangles) {
    const auto data = std::make_shared<Data>();
    data->list.reserve(triangles.size());
    for (const Triangle& triangle : triangles) {
        data->list.emplace_back(triangle[0], triangle[1], triangle[2]);
    }
    m_data = data;
}

FclModel::FclModel(MeshView mesh) : FclModel(FclPoints(mesh.vertices), FclTriangles(mesh.triangles)) {}

FclModel::FclModel(const FclPoints& points, const FclTriangles& triangles) : m_data(std::make_shared<Data>()) {
    fcl::BVHModel<fcl::OBBRSSd>& model = m_data->model;
    model.beginModel(static_cast<int>(triangles.m_data->list.size()), static_cast<int>(points.m_data->list.size()));
    model.addSubModel(points.m_data->list, triangles.m_data->list);
    model.endModel();
}

void FclModel::refit(const FclPoints& points) {
    fcl::BVHModel<fcl::OBBRSSd>& model = m_data->model;
    if (model.beginReplaceModel() != fcl::BVH_OK || model.replaceSubModel(points.m_data->list) != fcl::BVH_OK ||
        model.endReplaceModel(true, true) != fcl::BVH_OK) {
        throw std::runtime_error("FCL cannot refit this");
    }
}

bool FclModel::collides(const FclModel& b, const Pose& bInA) const {
    fcl::Transform3d pose = fcl::Transform3d::Identity();
    pose.linear() = bInA.rotation.cast<double>();
    pose.translation() = bInA.translation.cast<double>();
    fcl::CollisionRequestd request;
    request.num_max_contacts = 1;
    request.enable_contact = false;
    fcl::CollisionResultd result;
    fcl::collide(&m_data->model, fcl::Transform3d::Identity(), &b.m_data->model, pose, request, result);
    return result.isCollision();
}

std::optional<double> FclModel::impact(const Pose& from, const Pose& to, const FclModel& other, const Pose& otherFrom,
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

FclModel::Bytes FclModel::bytes() const {
    const fcl::BVHModel<fcl::OBBRSSd>& model = m_data->model;
    return {static_cast<std::size_t>(model.getNumBVs()) * sizeof(fcl::BVNode<fcl::OBBRSSd>),
            static_cast<std::size_t>(model.num_vertices) * sizeof(fcl::Vector3d) +
                static_cast<std::size_t>(model.num_tris) * sizeof(fcl::Triangle)};
}

}  // namespace grapeshot::bench
