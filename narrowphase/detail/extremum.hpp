// Is a feature of a mesh locally closest to another body that lies in a given direction?
//
// This work is based on:
// Ming Lin, John Canny. A fast algorithm for incremental distance calculation. ICRA 1991 (Voronoi regions of features)
// Andreas Baerentzen, Henrik Aanaes. Signed Distance Computation Using the Angle Weighted Pseudonormal. 2005
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>

#include <grapeshot/adb/point_query.hpp>
#include <grapeshot/narrowphase/mesh_model.hpp>

namespace grapeshot::detail {

/// Directions are in the mesh's frame and unit; `lean` is the sine by which a surface direction may lead towards the
/// other body.

/// By how much the cone of a vertex (MeshModel::vertexCones) is wider for a given lean, rad: where two edges meet at an
/// acute angle, directions that lead along neither by more than `lean` reach farther beyond the cone.
[[nodiscard]] inline float coneWidening(float lean) {
    return 3 * lean + 0.02F;
}
/// Least cosine to the vertex normal, given cosine and sine of the widening; -2: every direction.
[[nodiscard]] inline float widenedCone(const NormalCone& cone, float cosine, float sine) {
    const bool all = cone.cosine <= -1 || cone.sine * cosine + cone.cosine * sine <= 0;  // half a turn and more
    return all ? -2.0F : cone.cosine * cosine - cone.sine * sine;
}

/// The lean that a corner on a face is allowed: no more than the half angle of its own cone. A block may tilt by the
/// whole lean and still stand on all its corners; on a smooth surface only the corners around the lowest point are
/// contacts, or a ball would stand on a foot and roll like one.
[[nodiscard]] inline float cornerLean(const MeshModel& model, std::uint32_t vertex, float lean) {
    const NormalCone& cone = model.vertexCones[vertex];
    return cone.cosine > 0 ? std::min(lean, cone.sine) : lean;
}

/// No edge at the welded vertex leads along `towards`.
[[nodiscard]] bool cornerIsExtremal(const MeshModel& model, std::uint32_t vertex, const Eigen::Vector3f& towards,
                                    float lean);
/// Neither face at edge `edge` (0..2) of the triangle leads along `towards`, which is orthogonal to the edge.
[[nodiscard]] bool edgeIsExtremal(const MeshModel& model, std::uint32_t triangle, unsigned edge,
                                  const Eigen::Vector3f& towards, float lean);
/// `towards` is the face's normal; for sheets, or its opposite.
[[nodiscard]] bool faceIsExtremal(const MeshModel& model, std::uint32_t triangle, const Eigen::Vector3f& towards,
                                  float lean);

/// Pseudonormal of a feature (0..2 corner, 3..5 edge, 6 face): its sign against (x - closest point) tells inside from
/// outside. Not unit for edges; zero where it cancels.
[[nodiscard]] Eigen::Vector3f pseudonormal(const MeshModel& model, std::uint32_t triangle, int feature);

/// Is the point inside the solid, or no closer than `reach` to its surface and so unknown (then false)?
[[nodiscard]] bool isInside(const MeshModel& solid, const Eigen::Vector3f& point, float reach);

}  // namespace grapeshot::detail
