// What a mesh is like, before anything is built on it.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>

#include <grapeshot/core/mesh_view.hpp>

namespace grapeshot {

/// Findings about one mesh. Edges are those of the mesh after welding vertices of exactly equal position (loaders often
/// split vertices); NaN, infinite and out-of-range corners are counted and their triangles left out of everything else.
struct MeshReport {
    std::size_t vertices = 0;
    std::size_t triangles = 0;
    std::size_t distinctVertices = 0;     ///< after welding by exact position
    std::size_t unusedVertices = 0;       ///< referred to by no triangle
    std::size_t notFiniteVertices = 0;    ///< NaN or infinite
    std::size_t indicesOutOfRange = 0;    ///< triangle corners that name no vertex
    std::size_t degenerateTriangles = 0;  ///< repeated corner, or height below 1e-6 of the longest edge
    std::size_t boundaryEdges = 0;        ///< used by one triangle
    std::size_t nonManifoldEdges = 0;     ///< used by three or more
    std::size_t misorientedEdges = 0;     ///< used by two triangles in the same direction
    std::size_t pieces = 0;               ///< components connected by welded vertices
    bool closed = false;                  ///< no boundary, non-manifold or misoriented edge, and at least one triangle
    double volume = 0;                    ///< signed, m^3; negative: inside out. Meaningful if closed
    double area = 0;                      ///< m^2
    Eigen::Vector3f lower = Eigen::Vector3f::Zero();  ///< box of the finite, used vertices
    Eigen::Vector3f upper = Eigen::Vector3f::Zero();
    /// Largest |coordinate| times 2^-24, divided by the shortest non-zero edge: above about 0.01, single precision
    /// bends the triangles visibly. Move the mesh to its origin, or scale it.
    double relativePrecision = 0;
};

/// Never throws on bad data: it is what tells. O(n log n).
[[nodiscard]] MeshReport inspect(MeshView mesh);

/// The report in words, a line per finding; for people.
[[nodiscard]] std::string describe(const MeshReport& report);

/// Larger ones are refused: their squares would leave single precision's range in the kernels.
inline constexpr float largestCoordinate = 1e15F;

/// Throws Error (emptyMesh, notFinite, indexOutOfRange, noSurface, tooLarge) if a tree cannot be built on the mesh; the
/// message names the value and the first place. Open, non-manifold and inside-out meshes pass. Coordinates beyond
/// largestCoordinate are tooLarge.
void requireUsable(MeshView mesh);

}  // namespace grapeshot
