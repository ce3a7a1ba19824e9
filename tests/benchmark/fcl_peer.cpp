#include "fcl_peer.hpp"

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/math/bv/OBBRSS.h>
#include <fcl/narrowphase/collision.h>

namespace grapeshot::bench {

struct FclModel::State {
    fcl::BVHModel<fcl::OBBRSSd> model;
};

FclModel::FclModel(MeshView mesh) : m_state(std::make_unique<State>()) {
    std::vector<fcl::Vector3d> points;
    points.reserve(mesh.vertices.size());
    for (const Eigen::Vector3f& vertex : mesh.vertices) {
        points.push_back(vertex.cast<double>());
    }
    std::vector<fcl::Triangle> triangles;
    triangles.reserve(mesh.triangles.size());
    for (const Triangle& triangle : mesh.triangles) {
        triangles.emplace_back(triangle[0], triangle[1], triangle[2]);
    }
    m_state->model.beginModel(static_cast<int>(triangles.size()), static_cast<int>(points.size()));
    m_state->model.addSubModel(points, triangles);
    m_state->model.endModel();
}

FclModel::~FclModel() = default;
FclModel::FclModel(FclModel&&) noexcept = default;
FclModel& FclModel::operator=(FclModel&&) noexcept = default;

bool FclModel::decide(const FclModel& other, const Pose& otherInThis) const {
    fcl::Transform3d pose = fcl::Transform3d::Identity();
    pose.linear() = otherInThis.rotation.cast<double>();
    pose.translation() = otherInThis.translation.cast<double>();
    fcl::CollisionRequestd request;
    request.num_max_contacts = 1;
    request.enable_contact = false;
    fcl::CollisionResultd result;
    fcl::collide(&m_state->model, fcl::Transform3d::Identity(), &other.m_state->model, pose, request, result);
    return result.isCollision();
}

}  // namespace grapeshot::bench
