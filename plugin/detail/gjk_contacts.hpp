// A mesh against any convex shape, by Bullet's own GJK and EPA on each candidate triangle.
#pragma once

#include <BulletCollision/CollisionShapes/btConvexShape.h>
#include <LinearMath/btTransform.h>

#include <cstdint>
#include <vector>

#include <grapeshot/narrowphase/solid.hpp>
#include <grapeshot/plugin/precision.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

/// Contacts of the mesh (A) are with the solid's surface, its margin being part of it. GJK gives one point of a face
/// that lies on another; corners of polyhedra are asked too, the rest comes in later steps. One work unit for four
/// triangles or corners, which cost about as much as 16 elsewhere.
class ConvexSolid final : public Solid {
  public:
    /// `inMesh`: in the mesh's frame.
    ConvexSolid(const btConvexShape& convex, const btTransform& inMesh);
    [[nodiscard]] float distanceBound(const Eigen::Vector3f& center, const Eigen::Vector3f& half) const override;
    std::uint64_t regions(const MeshModel& mesh, float maxDistance, std::vector<SearchRegion>& out) const override;
    [[nodiscard]] std::uint64_t leafQuarters() const override { return 4; }
    std::uint64_t contacts(const MeshModel& mesh, float maxDistance, const LocalContactSettings& settings,
                           std::vector<SurfaceContact>& out, LeafChoice* choice) const override;
    [[nodiscard]] bool isWhole() const override { return false; }

  private:
    const btConvexShape& m_convex;
    btTransform m_inMesh;
    BoxSolid m_box;  // around it
};

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
