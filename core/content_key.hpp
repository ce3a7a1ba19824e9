// What a mesh is, in 128 bits.
#pragma once

#include <cstdint>

#include <grapeshot/core/mesh_view.hpp>

namespace grapeshot {

/// 128-bit hash of vertices and triangles (xxHash3), byte for byte.
struct ContentKey {
    std::uint64_t low = 0;
    std::uint64_t high = 0;
    friend bool operator==(const ContentKey&, const ContentKey&) = default;
};
/// O(n), several gigabytes a second.
[[nodiscard]] ContentKey contentKey(MeshView mesh) noexcept;

/// The same vertices and triangles, byte for byte.
[[nodiscard]] bool sameContent(MeshView left, MeshView right) noexcept;

}  // namespace grapeshot
