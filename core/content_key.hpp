// What a mesh is, or any bytes, in 128 bits.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include <grapeshot/core/mesh_view.hpp>

namespace grapeshot {

/// 128-bit hash (xxHash3).
struct ContentKey {
    std::uint64_t low = 0;
    std::uint64_t high = 0;
    friend bool operator==(const ContentKey&, const ContentKey&) = default;
};
/// Of vertices and triangles, byte for byte. O(n), several gigabytes a second.
[[nodiscard]] ContentKey contentKey(MeshView mesh) noexcept;

/// Of any bytes.
[[nodiscard]] ContentKey contentKey(std::span<const std::byte> bytes) noexcept;

/// The same vertices and triangles, byte for byte.
[[nodiscard]] bool sameContent(MeshView left, MeshView right) noexcept;

}  // namespace grapeshot
