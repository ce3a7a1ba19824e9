// The triangles of a surface while a tree is built over them: those of a piece of the tree stand together.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <grapeshot/core/sliced.hpp>
#include <grapeshot/scf/surface.hpp>

namespace grapeshot::detail {

// Of each, per work unit.
inline constexpr std::size_t trianglesPerUnit = 12;
inline constexpr std::size_t verticesPerUnit = 32;

/// Triangles that stand together, the last one excluded.
struct TriangleRange {
    std::uint32_t begin = 0, end = 0;
    [[nodiscard]] std::size_t size() const { return end - begin; }
    friend bool operator==(const TriangleRange&, const TriangleRange&) = default;
};

/// Of no use before `prepare` is through. The surface must stay where it is.
struct TriangleOrder {
    explicit TriangleOrder(const Surface& ofWhat) : surface(ofWhat) {}
    Sliced prepare();

    /// Distinct corners of the triangles, in `vertices`, and where they stand there, in `place`.
    Sliced gather(TriangleRange range);
    /// Are they of one connected piece of the surface?
    Sliced askOnePiece(TriangleRange range, bool& isOne) const;
    /// Names the connected piece of the triangle at a place of the order.
    [[nodiscard]] std::uint32_t pieceAt(std::size_t at) const { return piece[surface.triangles[order[at]][0]]; }

    const Surface& surface;
    std::vector<std::uint32_t> order;     ///< triangles
    std::vector<Eigen::Vector3f> middle;  ///< of each triangle
    std::vector<std::uint32_t> piece;     ///< lowest vertex index of the connected piece of each vertex
    std::vector<std::uint32_t> vertices, place;

  private:
    std::vector<std::uint32_t> m_stamp;
    std::uint32_t m_round = 0;
};

}  // namespace grapeshot::detail
