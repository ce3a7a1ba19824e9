// One of the two meshes of a pair, with its triangles and directions brought into A's frame.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>

#include <Eigen/Core>

#include <grapeshot/core/pose.hpp>
#include <grapeshot/narrowphase/detail/edge_contact.hpp>
#include <grapeshot/narrowphase/mesh_model.hpp>

namespace grapeshot::detail {

/// A triangle of one side, in A's frame.
struct PlacedTriangle {
    Eigen::Vector3f corner[3];
    Eigen::Vector3f normal;  ///< unit, or zero
    std::uint32_t triangle = noTriangle;
    std::uint16_t traits = 0;
};

/// The traits of edges that may touch others: of a solid the convex ones; a sheet has two sides. Inside a flat face
/// nothing ends.
[[nodiscard]] inline unsigned bentEdges(const MeshModel& model) {
    return model.solid ? unsigned{ridgeEdge} : unsigned{ridgeEdge} | unsigned{concaveEdge};
}

class MeshSide {
  public:
    MeshSide() = default;
    /// `pose`: of this mesh in A's frame; null for A itself.
    MeshSide(const MeshModel& model, const Pose* pose) : m_model(&model), m_pose(pose) {}

    [[nodiscard]] const MeshModel& model() const { return *m_model; }
    [[nodiscard]] const Pose* pose() const { return m_pose; }
    [[nodiscard]] bool isA() const { return m_pose == nullptr; }

    [[nodiscard]] Eigen::Vector3f pointToA(const Eigen::Vector3f& point) const {
        return m_pose == nullptr ? point : apply(*m_pose, point);
    }
    [[nodiscard]] Eigen::Vector3f directionToA(const Eigen::Vector3f& direction) const {
        return m_pose == nullptr ? direction : Eigen::Vector3f(m_pose->rotation * direction);
    }
    [[nodiscard]] Eigen::Vector3f pointFromA(const Eigen::Vector3f& point) const {
        return m_pose == nullptr ? point
                                 : Eigen::Vector3f(m_pose->rotation.transpose() * (point - m_pose->translation));
    }
    [[nodiscard]] Eigen::Vector3f directionFromA(const Eigen::Vector3f& direction) const {
        return m_pose == nullptr ? direction : Eigen::Vector3f(m_pose->rotation.transpose() * direction);
    }

    void place(std::uint32_t triangle, PlacedTriangle& out) const {
        const Triangle& corner = m_model->tree.triangles[triangle];
        for (unsigned c = 0; c < 3; ++c) {
            out.corner[c] = pointToA(m_model->tree.vertices[corner[c]]);
        }
        out.normal = directionToA(m_model->triangleNormals[triangle]);
        out.triangle = triangle;
        out.traits = m_model->traits[triangle];
    }

    [[nodiscard]] std::uint32_t weldedCorner(std::uint32_t triangle, unsigned corner) const {
        return m_model->topology.welded[m_model->tree.triangles[triangle][corner]];
    }
    [[nodiscard]] Eigen::Vector3f vertexNormal(std::uint32_t welded) const {
        return directionToA(m_model->vertexNormals[welded]);
    }

    /// Edge `edge` of a placed triangle, in the direction from its lower to its higher vertex, so that both triangles
    /// at it give the same numbers.
    [[nodiscard]] SurfaceEdge edge(const PlacedTriangle& triangle, unsigned edge) const {
        SurfaceEdge out;
        out.from = triangle.corner[edge];
        out.to = triangle.corner[(edge + 1) % 3];
        out.own = triangle.normal;
        const std::uint32_t other = m_model->topology.across[triangle.triangle][edge];
        out.across = other == noNeighbour ? Eigen::Vector3f(Eigen::Vector3f::Zero())
                                          : directionToA(m_model->triangleNormals[other]);
        out.sharp = (triangle.traits & (sharpEdge << edge)) != 0;
        out.solid = m_model->solid;
        if (weldedCorner(triangle.triangle, edge) > weldedCorner(triangle.triangle, (edge + 1) % 3)) {
            std::swap(out.from, out.to);
            std::swap(out.own, out.across);
        }
        return out;
    }
    /// The lower of the triangles at the edge.
    [[nodiscard]] std::uint32_t firstTriangle(std::uint32_t triangle, unsigned edge) const {
        return std::min(triangle, m_model->topology.across[triangle][edge]);
    }

  private:
    const MeshModel* m_model = nullptr;
    const Pose* m_pose = nullptr;
};

}  // namespace grapeshot::detail
