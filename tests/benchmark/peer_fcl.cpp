#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/math/bv/OBBRSS.h>
#include <fcl/narrowphase/collision.h>

#include "peer.hpp"

namespace grapeshot::bench {

namespace {

using Model = fcl::BVHModel<fcl::OBBRSSd>;

std::shared_ptr<const Model> modelOf(MeshView mesh) {
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
    auto model = std::make_shared<Model>();
    model->beginModel(static_cast<int>(triangles.size()), static_cast<int>(points.size()));
    model->addSubModel(points, triangles);
    model->endModel();
    return model;
}

}  // namespace

Peer fclPeer(MeshView a, MeshView b) {
    const std::shared_ptr<const Model> modelA = modelOf(a);
    const std::shared_ptr<const Model> modelB = a.triangles.data() == b.triangles.data() ? modelA : modelOf(b);
    return makePeer("FCL OBBRSS", [modelA, modelB](const Pose& bInA) {
        fcl::Transform3d pose = fcl::Transform3d::Identity();
        pose.linear() = bInA.rotation.cast<double>();
        pose.translation() = bInA.translation.cast<double>();
        fcl::CollisionRequestd request;
        request.num_max_contacts = 1;
        request.enable_contact = false;
        fcl::CollisionResultd result;
        fcl::collide(modelA.get(), fcl::Transform3d::Identity(), modelB.get(), pose, request, result);
        return result.isCollision();
    });
}

}  // namespace grapeshot::bench
