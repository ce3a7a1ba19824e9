#include <grapeshot/plugin/detail/height_field.hpp>

#include <utility>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

HeightField heightFieldOf(const btHeightfieldTerrainShape& shape) {
    // Bullet has functions to set these and none to read them.
    struct Opened : btHeightfieldTerrainShape {
        using btHeightfieldTerrainShape::btHeightfieldTerrainShape;
        static auto columns() { return &Opened::m_heightStickWidth; }
        static auto rows() { return &Opened::m_heightStickLength; }
        static auto flipped() { return &Opened::m_flipQuadEdges; }
        static auto diamonds() { return &Opened::m_useDiamondSubdivision; }
        static auto zigzag() { return &Opened::m_useZigzagSubdivision; }
    };
    HeightField field;
    field.shape = &shape;
    field.columns = shape.*Opened::columns();
    field.rows = shape.*Opened::rows();
    field.upAxis = shape.getUpAxis();
    field.flipped = shape.*Opened::flipped();
    field.diamonds = shape.*Opened::diamonds();
    field.zigzag = shape.*Opened::zigzag();
    return field;
}

btVector3 HeightField::vertex(int index) const {
    btVector3 result;
    shape->getVertex(index % columns, index / columns, result);
    return result;
}

Triangle HeightField::triangle(int index) const {
    const int part = index / trianglesPerPart();
    const int x = part / 2;
    const int y = index % trianglesPerPart();
    const bool first = part % 2 == 0;
    const auto sample = [&](int i, int j) { return static_cast<std::uint32_t>((y + j) * columns + x + i); };
    const bool otherDiagonal = flipped || (diamonds && ((x + y) & 1) == 0) || (zigzag && (y & 1) == 0);
    Triangle result;
    if (otherDiagonal) {
        result = first ? Triangle{sample(0, 0), sample(0, 1), sample(1, 1)}
                       : Triangle{sample(0, 0), sample(1, 1), sample(1, 0)};
    } else {
        result = first ? Triangle{sample(0, 0), sample(0, 1), sample(1, 0)}
                       : Triangle{sample(1, 0), sample(0, 1), sample(1, 1)};
    }
    if (upAxis != 1) {
        std::swap(result[1], result[2]);
    }
    return result;
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
