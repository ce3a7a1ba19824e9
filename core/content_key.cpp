#include <grapeshot/core/content_key.hpp>

#include <cstring>
#include <memory>
#include <new>
#include <span>

#include <xxhash.h>

#include <grapeshot/core/mesh_slices.hpp>

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

namespace {

ContentKey keyOf(MeshView mesh, const XXH128_hash_t& vertices, const XXH128_hash_t& triangles) {
    // The sizes keep apart what differs only in where the vertices end.
    const std::uint64_t parts[] = {mesh.vertices.size(),  vertices.low64,  vertices.high64,
                                   mesh.triangles.size(), triangles.low64, triangles.high64};
    const XXH128_hash_t hash = XXH3_128bits(parts, sizeof parts);
    return {hash.low64, hash.high64};
}

constexpr std::size_t bytesPerUnit = 1024;

using StateOwner = std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)>;

template <class T>
Sliced hashInSlices(std::span<const T> values, XXH128_hash_t& hash) {
    const StateOwner state(XXH3_createState(), &XXH3_freeState);
    if (state == nullptr) {
        throw std::bad_alloc();
    }
    XXH3_128bits_reset(state.get());
    const auto add = [&](std::size_t begin, std::size_t end) {
        XXH3_128bits_update(state.get(), values.data() + begin, (end - begin) * sizeof(T));
    };
    co_await inPieces(0, values.size(), bytesPerUnit / sizeof(T), add);
    hash = XXH3_128bits_digest(state.get());
}

}  // namespace

ContentKey contentKey(MeshView mesh) noexcept {
    return keyOf(mesh, XXH3_128bits(mesh.vertices.data(), mesh.vertices.size_bytes()),
                 XXH3_128bits(mesh.triangles.data(), mesh.triangles.size_bytes()));
}

Sliced contentKeyInSlices(MeshView mesh, ContentKey& key) {
    XXH128_hash_t vertices;
    XXH128_hash_t triangles;
    co_await hashInSlices(mesh.vertices, vertices);
    co_await hashInSlices(mesh.triangles, triangles);
    key = keyOf(mesh, vertices, triangles);
}

Sliced sameContentInSlices(MeshView left, MeshView right, bool& same) {
    same = left.vertices.size() == right.vertices.size() && left.triangles.size() == right.triangles.size();
    if (!same) {
        co_return;
    }
    const auto compareVertices = [&](std::size_t begin, std::size_t end) {
        same = same && sameBytes(left.vertices.subspan(begin, end - begin), right.vertices.subspan(begin, end - begin));
    };
    co_await inPieces(0, left.vertices.size(), bytesPerUnit / sizeof(Eigen::Vector3f), compareVertices);
    const auto compareTriangles = [&](std::size_t begin, std::size_t end) {
        same =
            same && sameBytes(left.triangles.subspan(begin, end - begin), right.triangles.subspan(begin, end - begin));
    };
    co_await inPieces(0, left.triangles.size(), bytesPerUnit / sizeof(Triangle), compareTriangles);
}

ContentKey contentKey(std::span<const std::byte> bytes) noexcept {
    const XXH128_hash_t hash = XXH3_128bits(bytes.data(), bytes.size());
    return {hash.low64, hash.high64};
}

}  // namespace grapeshot
