// Contacts of a carried surface, kept by the nodes of the body that carries it.
#pragma once

#include <BulletSoftBody/btSoftBody.h>

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include <grapeshot/core/mesh_view.hpp>

namespace grapeshot::soft {

/// Each vertex is a mean of nodes of the body below; in the order of the vertices.
struct CarriedSurface {
    struct Share {
        std::uint32_t node;
        float weight;  ///< those of a vertex add up to 1
    };
    std::vector<Share> shares;
    std::vector<std::uint32_t> ends;  ///< of each vertex, in `shares`
    std::vector<Triangle> triangles;

    [[nodiscard]] std::uint32_t vertices() const { return static_cast<std::uint32_t>(ends.size()); }
    [[nodiscard]] std::uint32_t begin(std::uint32_t vertex) const { return vertex == 0 ? 0 : ends[vertex - 1]; }
};

/// Of a vertex, if the nodes are there.
[[nodiscard]] Eigen::Vector3d placeOf(const CarriedSurface& surface, std::uint32_t vertex,
                                      const std::vector<Eigen::Vector3d>& nodes);

/// The body's own faces, each vertex a node.
[[nodiscard]] CarriedSurface ownSurface(const btSoftBody& body);

/// One point of the surface against another one of it or of a rigid body, world frame.
struct SurfaceContact {
    std::array<int, 3> a{-1, -1, -1}, b{-1, -1, -1};  ///< vertices of the surface; b: none if it is rigid
    std::array<float, 3> weightsA{}, weightsB{};
    Eigen::Vector3d normal = Eigen::Vector3d::UnitY();  ///< unit, to a
    double before = 0;  ///< distance along the normal at the begin of the step, m; negative: on the wrong side
    double offset = 0;  ///< of the rigid point along the normal at the end of the step, m
    bool rigid = false;
};

struct CoreNodes {
    std::vector<Eigen::Vector3d> before, now;  ///< m
    std::vector<double> inverseMass;           ///< 1 / kg
};

/// By Gauss and Seidel, one-sided: contacts push and never pull.
class ContactProjection {
  public:
    /// @param thickness m. What is nearer comes apart over some steps: what is thrown apart would swing.
    void read(const CarriedSurface& surface, const std::vector<SurfaceContact>& contacts, const CoreNodes& nodes,
              double thickness);
    void pass(CoreNodes& nodes);
    /// Against sliding, once after the passes. @param friction of what has pushed
    void rub(CoreNodes& nodes, double friction);
    /// Pushes with rigid bodies since `read`, kg m.
    [[nodiscard]] Eigen::Vector3d pushOnRigid() const;

  private:
    struct End {
        std::uint32_t node;
        double weight;
        double response;  // weight / mass
    };
    struct Point {
        std::uint32_t begin, end;  // in m_ends
        Eigen::Vector3d normal;
        double target;  // m
        double scale;   // kg
        double push;    // kg m
        bool rigid;
    };
    std::vector<End> m_ends;
    std::vector<Point> m_points;
};

}  // namespace grapeshot::soft
