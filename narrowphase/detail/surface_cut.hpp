// The curves in which two surfaces cut through each other.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include <grapeshot/adb/query.hpp>
#include <grapeshot/core/detail/triangle_cut.hpp>
#include <grapeshot/core/pose.hpp>
#include <grapeshot/narrowphase/mesh_model.hpp>

namespace grapeshot::detail {

/// One intersecting pair of triangles and its piece of the curve. A's frame.
struct CutPiece {
    TrianglePair pair;
    Eigen::Vector3f middle;
    float overlap = 0;  ///< translation that parts the two triangles, m
    TriangleCut segment;
    bool hasSegment = false;  ///< not if the two lie in one plane
};

/// Pieces that follow each other on a curve, or whose middles are within the spacing: [begin, end) of the pieces.
struct SurfaceCut {
    std::uint32_t begin = 0;
    std::uint32_t end = 0;
    Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< of the pieces
    /// Unit, on B pointing to A: moving A along it lessens the common volume most.
    Eigen::Vector3d normal = Eigen::Vector3d::UnitY();
};

struct SurfaceCuts {
    std::vector<CutPiece> pieces;
    std::vector<SurfaceCut> cuts;

    [[nodiscard]] std::span<const CutPiece> piecesOf(const SurfaceCut& cut) const {
        return {pieces.data() + cut.begin, cut.end - cut.begin};
    }
};

/// Of the overlapping ones among `pairs`. `out` is overwritten and its memory kept.
void findCuts(const MeshModel& a, const MeshModel& b, const Pose& bInA, std::span<const TriangleContact> pairs,
              float spacing, SurfaceCuts& out);

/// Corners in A's frame, in double.
[[nodiscard]] TriangleD cornersOf(const Tree& tree, std::uint32_t triangle);
[[nodiscard]] TriangleD cornersOf(const Tree& tree, std::uint32_t triangle, const Pose& pose);

}  // namespace grapeshot::detail
