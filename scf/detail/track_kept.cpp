// What is tracked already: tested, followed where it has parted.
#include <grapeshot/scf/detail/track_step.hpp>

#include <algorithm>
#include <cmath>

#include <grapeshot/scf/detail/prefetch.hpp>

namespace grapeshot::detail {
namespace {

constexpr int descentUnits = 24;

}  // namespace

void TrackStep::testTracked(double share) {
    PairBatch& batch = m_scratch.batch;
    const std::vector<TrackedPair>& tracked = m_memory.tracked;
    const std::uint64_t limit = shareOf(left(), share);
    struct Parted {
        VertexPair corners;
        TrackedPair tracked;
    };
    std::vector<Parted> toFollow;
    std::size_t next = 0;
    while (next < tracked.size() && left() > 0 && (limit == unlimited || m_work < limit)) {
        const std::size_t first = next;
        while (next < tracked.size() && !batch.isFull()) {
            if (next + 2 * batchWidth < tracked.size()) {
                prefetchTriangles(m_space, tracked[next + 2 * batchWidth].pair);
            }
            if (next + batchWidth < tracked.size()) {
                prefetchCorners(m_space, tracked[next + batchWidth].pair);
            }
            batch.add(m_space, tracked[next++].pair);
        }
        ++m_work;
        const int count = batch.run(m_space.reach + m_follow + m_settings.spacing);
        for (int lane = 0; lane < count; ++lane) {
            const TrackedPair& one = tracked[first + static_cast<std::size_t>(lane)];
            const float distance = batch.out().signedDistance[lane];
            if (distance <= m_space.reach) {
                accept(batch, lane, one.birth);
            } else if (distance <= m_space.reach + m_follow + m_settings.spacing) {
                toFollow.push_back({nearestCorners(m_space, one.pair), one});
                prefetchLists(m_space, toFollow.back().corners);
            }
        }
    }
    m_untested = next;
    m_out.carried = static_cast<std::uint32_t>(tracked.size() - next);
    for (std::size_t i = 0; i < toFollow.size(); ++i) {
        if (i + 2 < toFollow.size()) {
            prefetchAround(m_space, toFollow[i + 2].corners);
        }
        const auto& [corners, one] = toFollow[i];
        if (left() == 0 || (limit != unlimited && m_work >= limit)) {
            keepNear(one.pair, one.birth);
        } else {
            repair(corners, one.birth);
        }
    }
}

bool TrackStep::repair(const VertexPair& from, std::uint64_t birth) {
    return testFans(descend(m_space, from.a, from.b, descentUnits, m_work), birth);
}

bool TrackStep::isCoarse(const BallPair& pair) const {
    return (isBallLeaf(pair.a) && m_cellsA.coarse[ballIndex(pair.a)] != 0) ||
           (isBallLeaf(pair.b) && m_cellsB.coarse[ballIndex(pair.b)] != 0);
}

bool TrackStep::isFarAtRest(const VertexPair& vertices) const {
    if (!m_space.isSelf()) {
        return true;
    }
    const Surface& surface = m_space.a->tree().surface;
    const float least = m_space.exclusion + 2 * surface.longestEdge;
    return (surface.rest[vertices.a] - surface.rest[vertices.b]).squaredNorm() > least * least;
}

bool TrackStep::testFans(const VertexPair& vertices, std::uint64_t birth) {
    const auto longestEdge = [](const PosedTree& side, std::uint32_t vertex) {
        const Eigen::Vector3f from = side.point(vertex);
        float square = 0;
        for (const std::uint32_t other : side.tree().surface.ring.of(vertex)) {
            square = std::max(square, (side.point(other) - from).squaredNorm());
        }
        return std::sqrt(square);
    };
    const float interesting = m_space.reach + m_follow;
    if (std::sqrt(vertices.square) >
        interesting + longestEdge(*m_space.a, vertices.a) + longestEdge(*m_space.b, vertices.b)) {
        return false;
    }
    PairBatch& batch = m_scratch.batch;
    TrackedContact nearest;
    nearest.pair = {noTriangle, noTriangle};
    nearest.signedDistance = interesting;
    bool isContact = false;
    const auto run = [&] {
        ++m_work;
        const int count = batch.run(interesting);
        for (int lane = 0; lane < count && !isContact; ++lane) {
            const float distance = batch.out().signedDistance[lane];
            if (distance <= m_space.reach) {
                accept(batch, lane, birth);
                isContact = true;
            } else if (distance <= nearest.signedDistance) {
                batch.describe(lane, nearest);
            }
        }
    };
    const bool isFar = isFarAtRest(vertices);
    for (const std::uint32_t a : m_space.a->tree().surface.fan.of(vertices.a)) {
        for (const std::uint32_t b : m_space.b->tree().surface.fan.of(vertices.b)) {
            if (!isFar && m_space.leavesOut(a, b)) {
                continue;
            }
            batch.add(m_space, {a, b});
            if (batch.isFull()) {
                run();
                if (isContact) {
                    return true;
                }
            }
        }
    }
    if (batch.size() > 0) {
        run();
    }
    if (!isContact && nearest.pair.triangleA != noTriangle && m_follow > 0) {
        keepNear(nearest, birth);
    }
    return isContact;
}

}  // namespace grapeshot::detail
