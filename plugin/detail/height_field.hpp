// The triangles of a btHeightfieldTerrainShape, by number.
//
// Bullet lists them for a box only. Here they are in the order of the names that it gives: the cells of a column along
// the field's first axis make two parts, one of their first triangles and one of their second. Their winding is made to
// show the side of growing heights, which Bullet's does for one of three axes.
#pragma once

#include <BulletCollision/CollisionShapes/btHeightfieldTerrainShape.h>

#include <grapeshot/core/mesh_view.hpp>
#include <grapeshot/plugin/precision.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

/// How a field is laid out; heights and scale are the shape's. Equal while the same samples make the same triangles.
struct HeightField {
    const btHeightfieldTerrainShape* shape = nullptr;  ///< null: none
    int columns = 0, rows = 0;                         ///< samples along the two axes across the heights
    int upAxis = 1;
    bool flipped = false, diamonds = false, zigzag = false;
    friend bool operator==(const HeightField&, const HeightField&) = default;

    /// Of sample `index` (row by row), shape's frame, scaled, m.
    [[nodiscard]] btVector3 vertex(int index) const;
    /// Samples of triangle `index`, heights growing outwards; for a scale that does not mirror.
    [[nodiscard]] Triangle triangle(int index) const;
    [[nodiscard]] long long vertices() const { return 1LL * columns * rows; }
    [[nodiscard]] int parts() const { return 2 * (columns - 1); }
    [[nodiscard]] int trianglesPerPart() const { return rows - 1; }
    [[nodiscard]] long long triangles() const { return 1LL * parts() * trianglesPerPart(); }
};

[[nodiscard]] HeightField heightFieldOf(const btHeightfieldTerrainShape& shape);

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
