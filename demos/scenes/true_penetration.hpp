// How deep two meshes really are in each other: the judge of saved poses, independent of every method that it judges.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include <grapeshot/core/mesh_view.hpp>

namespace grapeshot::scenes {

/// A rigid pose in double precision.
struct PoseD {
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
    Eigen::Vector3d translation = Eigen::Vector3d::Zero();
};

/// A mesh prepared for being asked; its own bounding-volume hierarchy in double precision, which shares no code with
/// the library's.
class TrueSurface {
  public:
    explicit TrueSurface(MeshView mesh);
    ~TrueSurface();
    TrueSurface(TrueSurface&&) noexcept;
    TrueSurface& operator=(TrueSurface&&) noexcept;

    /// Signed distance of a point in the mesh's frame, m: negative inside (by the angle-weighted pseudonormal; sheets
    /// have no inside: always >= 0).
    [[nodiscard]] double signedDistance(const Eigen::Vector3d& point) const;
    [[nodiscard]] const std::vector<Eigen::Vector3d>& samples() const;  ///< vertices and edge middles, mesh frame
    [[nodiscard]] const Eigen::Vector3d& lower() const;
    [[nodiscard]] const Eigen::Vector3d& upper() const;
    [[nodiscard]] bool closed() const;

  private:
    struct State;
    std::unique_ptr<State> m_state;
};

/// The largest depth of a sample of one mesh inside the other, m; 0 if none is. Poses are of the bodies in the world.
[[nodiscard]] double truePenetration(const TrueSurface& a, const PoseD& poseA, const TrueSurface& b,
                                     const PoseD& poseB);

/// Depth of the mesh's samples below the half-space normal . x <= offset (world frame), m.
[[nodiscard]] double penetrationBelowPlane(const TrueSurface& a, const PoseD& poseA, const Eigen::Vector3d& normal,
                                           double offset);

/// Depth of the mesh's samples inside a solid box of the given half extents, m.
[[nodiscard]] double penetrationIntoBox(const TrueSurface& a, const PoseD& poseA, const Eigen::Vector3d& half,
                                        const PoseD& boxPose);

}  // namespace grapeshot::scenes
