#include <grapeshot/core/content_key.hpp>

#include <cstring>
#include <span>

#include <xxhash.h>

namespace grapeshot {
namespace {

template <class T>
bool sameBytes(std::span<const T> left, std::span<const T> right) {
    return left.size() == right.size() &&
           (left.empty() || std::memcmp(left.data(), right.data(), left.size_bytes()) == 0);
}

}  // namespace

bool sameContent(MeshView left, MeshView right) noexcept {
    return sameBytes(left.vertices, right.vertices) && sameBytes(left.triangles, right.triangles);
}

ContentKey contentKey(MeshView mesh) noexcept {
    const XXH128_hash_t vertices = XXH3_128bits(mesh.vertices.data(), mesh.vertices.size_bytes());
    const XXH128_hash_t triangles = XXH3_128bits(mesh.triangles.data(), mesh.triangles.size_bytes());
    // The sizes keep apart what differs only in where the vertices end.
    const std::uint64_t parts[] = {mesh.vertices.size(),  vertices.low64,  vertices.high64,
                                   mesh.triangles.size(), triangles.low64, triangles.high64};
    const XXH128_hash_t hash = XXH3_128bits(parts, sizeof parts);
    return {hash.low64, hash.high64};
}

ContentKey contentKey(std::span<const std::byte> bytes) noexcept {
    const XXH128_hash_t hash = XXH3_128bits(bytes.data(), bytes.size());
    return {hash.low64, hash.high64};
}

}  // namespace grapeshot
