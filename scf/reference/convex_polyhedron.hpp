// A convex polyhedron with its features: vertices, edges, faces.
//
// This work is based on:
// Ming Lin, John Canny. A Fast Algorithm for Incremental Distance Calculation. ICRA 1991
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <grapeshot/core/mesh_view.hpp>

namespace grapeshot::scf::reference {

/// Why a mesh is no convex polyhedron.
enum class NotConvexReason {
    open,           ///< an edge without exactly two faces of consistent orientation
    flat,           ///< a face without area
    concave,        ///< a corner above the face of its neighbour (an inside-out mesh is that everywhere)
    severalPieces,  ///< convex, but more than one
};
[[nodiscard]] std::string_view name(NotConvexReason reason) noexcept;

/// `what()` reads "notConvex: <reason> (<place>)".
class NotConvex : public std::invalid_argument {
  public:
    NotConvex(NotConvexReason reason, const std::string& place);
    [[nodiscard]] NotConvexReason reason() const noexcept { return m_reason; }

  private:
    NotConvexReason m_reason;
};

enum class FeatureKind : std::uint8_t { vertex, edge, face };

struct Feature {
    FeatureKind kind = FeatureKind::vertex;
    std::uint32_t index = 0;
    friend bool operator==(const Feature&, const Feature&) = default;
};

/// Faces are triangles; two in one plane are two features, which costs a step now and then and nothing else.
struct ConvexPolyhedron {
    struct Edge {
        std::array<std::uint32_t, 2> ends;
        std::array<std::uint32_t, 2> faces;
    };
    struct Face {
        std::array<std::uint32_t, 3> corners;  ///< counter-clockwise seen from outside
        std::array<std::uint32_t, 3> edges;    ///< corner e to corner e + 1
    };

    std::vector<Eigen::Vector3d> vertices;  ///< m, in the body's frame
    std::vector<Edge> edges;
    std::vector<Face> faces;
    std::vector<std::uint32_t> edgesBegin;  ///< per vertex, and the end
    std::vector<std::uint32_t> edgesAround;
    double size = 0;  ///< diagonal of the box, m

    [[nodiscard]] std::span<const std::uint32_t> edgesOf(std::uint32_t vertex) const {
        return {edgesAround.data() + edgesBegin[vertex], edgesBegin[vertex + 1] - edgesBegin[vertex]};
    }
    /// Vertices of the feature, one to three.
    [[nodiscard]] std::span<const std::uint32_t> cornersOf(const Feature& feature) const;
    [[nodiscard]] std::size_t count(FeatureKind kind) const;
};

/// Vertices at one position become one. Neighbouring faces may bend inwards by 1e-6 of the size: that much single
/// precision bends them anyway.
/// @throws Error as requireUsable(MeshView) does; NotConvex
[[nodiscard]] ConvexPolyhedron convexPolyhedron(MeshView mesh);

}  // namespace grapeshot::scf::reference
