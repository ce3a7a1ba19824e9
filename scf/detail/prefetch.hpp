// Hints to the memory of what will be read next. On large meshes a tracked pair is some twenty misses of the cache, one
// after the other; those of the pairs after it may as well run beside them. Results do not depend on it.
#pragma once

#include <cstdint>

#include <grapeshot/scf/detail/descent.hpp>
#include <grapeshot/scf/detail/pair_space.hpp>

namespace grapeshot::detail {

/// What is listed of two pieces, whose turn is after some other pairs'; and, some pairs later, the positions.
inline void prefetchPieces(const PairSpace& space, const BallPair& pair) {
    space.a->prefetchPiece(pair.a);
    space.b->prefetchPiece(pair.b);
}
inline void prefetchChildren(const PairSpace& space, const ChildPairs& children) {
    for (unsigned i = 0; i < 4; ++i) {
        if ((children.mask >> 4 * i & 15U) != 0U) {
            space.a->prefetchPiece(children.a[i]);
        }
        if ((children.mask >> i & 0x1111U) != 0U) {
            space.b->prefetchPiece(children.b[i]);
        }
    }
}
inline void prefetchPoints(const PairSpace& space, const BallPair& pair) {
    space.a->prefetchPoints(pair.a);
    space.b->prefetchPoints(pair.b);
}

/// The corners' indices, and the leaves that the triangles are in.
inline void prefetchTriangles(const PairSpace& space, const TrianglePair& pair) {
    __builtin_prefetch(&space.a->tree().surface.triangles[pair.triangleA]);
    __builtin_prefetch(&space.b->tree().surface.triangles[pair.triangleB]);
    __builtin_prefetch(&space.a->tree().leafOfTriangle[pair.triangleA]);
    __builtin_prefetch(&space.b->tree().leafOfTriangle[pair.triangleB]);
}

/// The positions of the corners.
inline void prefetchCorners(const PairSpace& space, const TrianglePair& pair) {
    for (const std::uint32_t v : space.a->tree().surface.triangles[pair.triangleA]) {
        space.a->prefetch(v);
    }
    for (const std::uint32_t v : space.b->tree().surface.triangles[pair.triangleB]) {
        space.b->prefetch(v);
    }
}

/// Where the neighbours and the triangles of two vertices are listed.
inline void prefetchLists(const PairSpace& space, const VertexPair& vertices) {
    const auto one = [](const Surface& surface, std::uint32_t v) {
        __builtin_prefetch(&surface.ring.begin[v]);
        __builtin_prefetch(&surface.fan.begin[v]);
    };
    one(space.a->tree().surface, vertices.a);
    one(space.b->tree().surface, vertices.b);
}

/// The neighbours and the triangles themselves.
inline void prefetchAround(const PairSpace& space, const VertexPair& vertices) {
    const auto one = [&](const PosedTree& side, std::uint32_t v) {
        const Surface& surface = side.tree().surface;
        for (const std::uint32_t next : surface.ring.of(v)) {
            side.prefetch(next);
            if (space.isSelf()) {
                __builtin_prefetch(&surface.rest[next]);
            }
        }
        for (const std::uint32_t triangle : surface.fan.of(v)) {
            __builtin_prefetch(&surface.triangles[triangle]);
        }
    };
    one(*space.a, vertices.a);
    one(*space.b, vertices.b);
}

}  // namespace grapeshot::detail
