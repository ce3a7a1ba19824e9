// Seeded pairs of triangles, one class per hazard of the kernels.
#pragma once

#include <array>
#include <span>
#include <vector>

#include <grapeshot/core/triangle_batch.hpp>
#include <support/oracle.hpp>
#include <support/poses.hpp>

namespace grapeshot::test {

using TriangleF = std::array<Eigen::Vector3f, 3>;

struct TrianglePairF {
    TriangleF a, b;
};

enum class PairKind {
    anywhere,        ///< corners uniform in a cube
    unlikeSize,      ///< B a tenth to a hundred-thousandth of A
    edgeOnEdge,      ///< two edges within 1e-7 to 1e-2
    cornerOnFace,    ///< likewise
    almostParallel,  ///< edges within 1e-6 to 1 rad of parallel, and close
    sliver,          ///< height 1e-5 to 1e-1 of the length
    almostCoplanar,  ///< within 1e-7 to 1e-1
    coplanar,        ///< exactly, in a coordinate plane
    lattice,         ///< small integer coordinates: touching, shared corners, parallel edges
    degenerate,      ///< segments and points among them
};
inline constexpr std::array allKinds = {PairKind::anywhere,       PairKind::unlikeSize,     PairKind::edgeOnEdge,
                                        PairKind::cornerOnFace,   PairKind::almostParallel, PairKind::sliver,
                                        PairKind::almostCoplanar, PairKind::coplanar,       PairKind::lattice,
                                        PairKind::degenerate};
const char* nameOf(PairKind kind);

TrianglePairF makePair(PairKind kind, Random& random);

/// Sixteen pairs as the kernels take them.
struct PairBatch {
    std::array<TrianglePairF, batchWidth> pairs;
    TriangleBatch a, b;
};
PairBatch toBatch(std::span<const TrianglePairF> pairs);
PairBatch makeBatch(PairKind kind, Random& random);

Corners toCorners(const TriangleF& triangle);
/// Largest distance of a corner from A's first corner.
double extentOf(const TrianglePairF& pair);

}  // namespace grapeshot::test
