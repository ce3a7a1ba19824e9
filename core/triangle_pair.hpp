// Two triangles, one of each mesh.
#pragma once

#include <compare>
#include <cstdint>

namespace grapeshot {

inline constexpr std::uint32_t noTriangle = 0xffffffffU;

/// Two triangles, one of each mesh, by their index in the mesh.
struct TrianglePair {
    std::uint32_t triangleA = noTriangle;
    std::uint32_t triangleB = noTriangle;
    friend bool operator==(const TrianglePair&, const TrianglePair&) = default;
    friend auto operator<=>(const TrianglePair&, const TrianglePair&) = default;
};

}  // namespace grapeshot
