#include <grapeshot/core/content_key.hpp>

#include <xxhash.h>

namespace grapeshot {

ContentKey contentKey(MeshView mesh) noexcept {
    const XXH128_hash_t vertices = XXH3_128bits(mesh.vertices.data(), mesh.vertices.size_bytes());
    const XXH128_hash_t triangles = XXH3_128bits(mesh.triangles.data(), mesh.triangles.size_bytes());
    // The sizes keep apart what differs only in where the vertices end.
    const std::uint64_t parts[] = {mesh.vertices.size(),  vertices.low64,  vertices.high64,
                                   mesh.triangles.size(), triangles.low64, triangles.high64};
    const XXH128_hash_t hash = XXH3_128bits(parts, sizeof parts);
    return {hash.low64, hash.high64};
}

}  // namespace grapeshot
