#include <grapeshot/scf/reference/detail/fan_distance.hpp>

#include <algorithm>
#include <limits>

#include <grapeshot/core/triangle_batch.hpp>

namespace grapeshot::scf::reference::detail {

namespace {

void put(TriangleBatch& batch, std::size_t lane, const std::array<Eigen::Vector3f, 3>& corners) {
    for (std::size_t c = 0; c < 3; ++c) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            batch.corner[c][axis][lane] = corners[c][static_cast<Eigen::Index>(axis)];
        }
    }
}

}  // namespace

FanDistance fanDistance(const PlacedSurface& a, std::uint32_t featureA, const PlacedSurface& b, std::uint32_t featureB,
                        std::size_t& pairs) {
    const auto fanA = a.surface().fan[featureA];
    const auto fanB = b.surface().fan[featureB];
    const std::size_t count = fanA.size() * fanB.size();
    pairs += count;
    FanDistance best;
    best.distance = std::numeric_limits<float>::infinity();
    TriangleBatch batchA;
    TriangleBatch batchB;
    DistanceBatch distances;
    for (std::size_t begin = 0; begin < count; begin += batchWidth) {
        const std::size_t lanes = std::min<std::size_t>(batchWidth, count - begin);
        for (std::size_t lane = 0; lane < batchWidth; ++lane) {  // the last pair once more in lanes without one
            const std::size_t i = begin + std::min(lane, lanes - 1);
            put(batchA, lane, a.corners(fanA[i / fanB.size()]));
            put(batchB, lane, b.corners(fanB[i % fanB.size()]));
        }
        signedDistances(batchA, batchB, distances);
        for (std::size_t lane = 0; lane < lanes; ++lane) {
            const bool overlapping = (distances.overlapping >> lane & 1U) != 0;
            const float distance = overlapping ? 0 : distances.signedDistance[lane];
            if (distance < best.distance) {
                const std::size_t i = begin + lane;
                best = {distance, fanA[i / fanB.size()], fanB[i % fanB.size()]};
            }
        }
    }
    return best;
}

}  // namespace grapeshot::scf::reference::detail
