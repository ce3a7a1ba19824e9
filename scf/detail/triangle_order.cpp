#include <grapeshot/scf/detail/triangle_order.hpp>

#include <grapeshot/scf/detail/sliced_vectors.hpp>

namespace grapeshot::detail {
namespace {

constexpr std::uint32_t none = 0xffffffffU;
constexpr std::size_t visitsPerUnit = 4;

/// Lowest vertex index of the connected piece of each vertex.
Sliced findPieces(const Surface& surface, std::vector<std::uint32_t>& piece) {
    co_await fillInSlices(piece, surface.rest.size(), none);
    std::vector<std::uint32_t> open;
    std::size_t visits = 0;
    for (std::uint32_t v = 0; v < piece.size(); ++v) {
        if (v % 256 == 0) {
            co_yield 2;
        }
        if (piece[v] != none) {
            continue;
        }
        piece[v] = v;
        open.push_back(v);
        while (!open.empty()) {
            if (visits++ % (mostSlicedPiece * visitsPerUnit) == 0) {
                co_yield mostSlicedPiece;
            }
            const std::uint32_t from = open.back();
            open.pop_back();
            for (const std::uint32_t other : surface.ring.of(from)) {
                if (piece[other] == none) {
                    piece[other] = v;
                    open.push_back(other);
                }
            }
        }
    }
}

}  // namespace

Sliced TriangleOrder::prepare() {
    co_await findPieces(surface, piece);
    const std::size_t triangles = surface.triangles.size();
    // What grows would be copied in one piece.
    vertices.reserve(surface.rest.size());
    order.reserve(triangles);
    middle.reserve(triangles);
    const auto list = [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const Triangle& t = surface.triangles[i];
            order.push_back(static_cast<std::uint32_t>(i));
            middle.emplace_back((surface.rest[t[0]] + surface.rest[t[1]] + surface.rest[t[2]]) / 3);
        }
    };
    co_await inPieces(0, triangles, trianglesPerUnit, list);
    co_await fillInSlices(place, surface.rest.size(), 0U);
    co_await fillInSlices(m_stamp, surface.rest.size(), 0U);
}

Sliced TriangleOrder::gather(TriangleRange range) {
    ++m_round;
    vertices.clear();
    const auto list = [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            for (const std::uint32_t v : surface.triangles[order[i]]) {
                if (m_stamp[v] != m_round) {
                    m_stamp[v] = m_round;
                    place[v] = static_cast<std::uint32_t>(vertices.size());
                    vertices.push_back(v);
                }
            }
        }
    };
    co_await inPieces(range.begin, range.end, trianglesPerUnit, list);
}

Sliced TriangleOrder::askOnePiece(TriangleRange range, bool& isOne) const {
    isOne = true;
    const auto compare = [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end && isOne; ++i) {
            isOne = pieceAt(i) == pieceAt(range.begin);
        }
    };
    co_await inPieces(range.begin + 1, range.end, verticesPerUnit, compare);
}

}  // namespace grapeshot::detail
