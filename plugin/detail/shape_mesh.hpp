// The triangles of a Bullet shape, in one form for all kinds.
//
// Traps that end here: a GImpact mesh consists of parts, each with its own scale, and ignores the scale of its mesh
// interface but at construction; a BVH mesh takes the interface's; a scaled one both. Indices of 8, 16 or 32 bits,
// vertices in float or double, any stride. A mirroring scale turns triangles inside out: their corners are swapped. A
// height field has no triangles at all, only heights: detail/height_field.hpp.
#pragma once

#include <BulletCollision/CollisionShapes/btStridingMeshInterface.h>

#include <cstdint>
#include <span>
#include <vector>

#include <grapeshot/core/mesh_view.hpp>
#include <grapeshot/core/sliced.hpp>
#include <grapeshot/plugin/detail/height_field.hpp>
#include <grapeshot/plugin/precision.hpp>

class btCollisionShape;

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

/// Triangles from `firstTriangle` on belong to Bullet's part `part`.
struct MeshPart {
    int part = 0;
    std::uint32_t firstTriangle = 0;
    friend bool operator==(const MeshPart&, const MeshPart&) = default;
};

/// As Bullet's contact points name a triangle.
struct TriangleId {
    int part = -1;
    int index = -1;
};
[[nodiscard]] TriangleId idOf(std::span<const MeshPart> parts, std::uint32_t triangle);

struct ShapeMesh {
    std::vector<Eigen::Vector3f> vertices;  ///< shape's frame, scaled, m
    std::vector<Triangle> triangles;
    std::vector<MeshPart> parts;
    [[nodiscard]] MeshView view() const { return {vertices, triangles}; }
};

/// One part of a shape as Bullet describes it. Compares equal while the same arrays are read the same way.
struct PartSource {
    const btStridingMeshInterface* mesh = nullptr;
    int part = 0;
    double scale[3] = {1, 1, 1};
    const unsigned char* vertexBase = nullptr;
    int vertices = 0;
    PHY_ScalarType vertexType = PHY_FLOAT;
    int vertexStride = 0;
    const unsigned char* indexBase = nullptr;
    int indexStride = 0;
    int triangles = 0;
    PHY_ScalarType indexType = PHY_INTEGER;
    HeightField field;  ///< in place of arrays
    friend bool operator==(const PartSource&, const PartSource&) = default;

    /// Scaled and narrowed; NaN beyond single precision.
    [[nodiscard]] Eigen::Vector3f vertex(int index) const;
    /// Indices within the part, as they stand there: not checked.
    [[nodiscard]] Triangle triangle(int index) const;
};

/// Appends the parts of a mesh shape (see isMesh). The arrays are those that the interface gives out when it is locked;
/// they are read after it is unlocked, as Bullet's own shapes do between steps.
/// @throws Error: emptyMesh (no interface, null arrays), badSetting (scale 0 or not finite, unknown types, negative
/// counts), indexOutOfRange (a part that does not exist), tooLarge (a height field of more than 2^31 triangles)
void sourcesOf(const btCollisionShape& shape, std::vector<PartSource>& sources);

/// Copies everything.
/// @throws Error tooLarge, indexOutOfRange
[[nodiscard]] ShapeMesh readMesh(std::span<const PartSource> sources);
/// The same in slices. Between them the shape must stay alive, and `sources` too.
Sliced readMeshInSlices(std::span<const PartSource> sources, ShapeMesh& mesh);

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
