// Everything that is built once per mesh and shared by all bodies that use it.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <grapeshot/adb/tree.hpp>
#include <grapeshot/core/mesh_report.hpp>
#include <grapeshot/core/topology.hpp>
#include <grapeshot/narrowphase/feature_model.hpp>

namespace grapeshot {

/// Sense of "collide".
enum class Interior {
    surface,  ///< only surfaces; a body inside another is free
    solid,    ///< closed meshes: one inside the other collides
};

/// What the contact search asks of a triangle's surroundings, precomputed; shift by the edge or corner, 0..2.
enum SurfaceTrait : std::uint16_t {
    sharpEdge = 1U,    ///< convex by more than 0.09 rad, or without a neighbour
    concaveEdge = 8U,  ///< the neighbour rises above this triangle's plane
    flatCorner = 64U,  ///< all triangles around the vertex lie in one plane: never the end of anything
    ridgeEdge = 512U,  ///< convex, or without a neighbour: edges of a solid touch others only here
};

/// Half angle of a cone of directions; cosine -1: every direction.
struct NormalCone {
    float cosine = -1, sine = 0;
};

/// Sine: leans beyond it are bounded less tightly (LeafShape::touch).
inline constexpr float usualLean = 0.08F;

/// A leaf block seen from outside, mesh frame: its box and a cone of the directions in which it can be touched. One
/// cache line of floats, which LeafFilter reads as such.
struct alignas(64) LeafShape {
    Eigen::Vector3f center = Eigen::Vector3f::Zero();  ///< of the box, m
    Eigen::Vector3f half = Eigen::Vector3f::Zero();    ///< half extents, m
    Eigen::Vector3f axis = Eigen::Vector3f::UnitX();   ///< of the cone
    float cosSpread = -1;                              ///< of the cone's half angle; -1: every direction
    float sinSpread = 0;
    /// About the same axis: every line from the leaf to what touches it across a gap, at a lean of up to usualLean.
    /// Cosine 0 or less: no such bound.
    NormalCone touch;
    float plain = 0;  ///< 1: inside a flat face, no corner and no edge that anything could end at; else 0
    float unused[2] = {};
};
static_assert(sizeof(LeafShape) == 64);

struct MeshModel {
    Tree tree;
    Topology topology;
    MeshReport report;
    /// Angle-weighted unit normal per welded vertex (zero where it cancels): tells inside from outside at corners.
    /// Baerentzen, Aanaes: Signed Distance Computation Using the Angle Weighted Pseudonormal, 2005.
    std::vector<Eigen::Vector3f> vertexNormals;
    /// The directions in which a welded vertex can be touched are within a cone about its normal, which holds the
    /// normals of its triangles.
    std::vector<NormalCone> vertexCones;
    /// Unit normal per triangle; zero for degenerate ones.
    std::vector<Eigen::Vector3f> triangleNormals;
    /// Which edges and corners of a triangle can carry a contact (bits of SurfaceTrait).
    std::vector<std::uint16_t> traits;
    /// The lowest triangle at each welded vertex; noTriangle at a vertex that no triangle uses.
    std::vector<std::uint32_t> vertexTriangle;
    std::vector<LeafShape> leafShapes;  ///< by leaf block of the tree
    std::vector<std::uint32_t> leafOf;  ///< the leaf block of a triangle
    /// Closed and not inside out: inside and outside mean something, so penetration has a sign.
    bool solid = false;
    /// For Method::scf; null: not wanted, and then such pairs are left to adb. Copies share it.
    std::shared_ptr<const FeatureModel> features;
    /// 0: the vertices are where they were when `features` was built. Else no edge is more than so many times as long.
    float featureStretch = 0;
};

/// @throws Error as `build` does. Not tuned by default: contacts ask for no estimate of a decision.
[[nodiscard]] MeshModel makeModel(MeshView mesh, const BuildSettings& settings = {.tuningPoses = 0});
/// Around a tree that is there already.
[[nodiscard]] MeshModel makeModelOf(Tree tree);
/// With all that Method::scf needs. About 5 us a triangle more, and 110 bytes beside 160.
[[nodiscard]] MeshModel makeTrackedModel(MeshView mesh, const BuildSettings& settings = {.tuningPoses = 0});
/// What `features` lacks is added. About 5 us a triangle. @throws Error as buildBallTree does
void addFeatures(MeshModel& model);

/// Moves the model to new vertex positions; topology stays. @throws Error as `refit` does; unchanged then.
void refit(MeshModel& model, std::span<const Eigen::Vector3f> vertices);

}  // namespace grapeshot
