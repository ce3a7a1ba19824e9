#include <grapeshot/plugin/detail/thin_pairs.hpp>

#include <algorithm>
#include <cmath>
#include <tuple>

#include <grapeshot/core/triangle_batch.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

namespace {

using Eigen::Vector3f;

bool areNeighbours(const Triangle& a, const Triangle& b, const IndexLists& near) {
    return std::ranges::any_of(a, [&](std::uint32_t v) {
        return std::ranges::any_of(b, [&](std::uint32_t w) { return std::ranges::binary_search(near.of(v), w); });
    });
}

}  // namespace

void ThinPairs::find(const BallTree& tree, const SurfaceInStep& body, std::span<const TrianglePair> pairs,
                     float distance, float spacing, const IndexLists* near, std::vector<TrianglePair>& thin) {
    thin.clear();
    m_within.clear();
    m_candidates.clear();
    std::uint32_t known = noTriangle;
    Vector3f low = Vector3f::Zero();
    Vector3f high = Vector3f::Zero();
    const auto box = [&](std::uint32_t t, Vector3f& from, Vector3f& to) {
        const Triangle& c = body.triangles[t];
        from = body.after[c[0]].cwiseMin(body.after[c[1]]).cwiseMin(body.after[c[2]]);
        to = body.after[c[0]].cwiseMax(body.after[c[1]]).cwiseMax(body.after[c[2]]);
    };
    for (const TrianglePair& pair : pairs) {
        if (pair.triangleA != known) {
            known = pair.triangleA;
            box(known, low, high);
            low.array() -= distance;
            high.array() += distance;
        }
        Vector3f from, to;
        box(pair.triangleB, from, to);
        if ((low.array() <= to.array()).all() && (from.array() <= high.array()).all()) {
            m_within.push_back(pair);
        }
    }
    TriangleBatch first, second;
    DistanceBatch found;
    const auto gather = [&](TriangleBatch& batch, int lane, std::uint32_t t) {
        for (int corner = 0; corner < 3; ++corner) {
            const Vector3f& at = body.after[body.triangles[t][static_cast<std::size_t>(corner)]];
            for (int axis = 0; axis < 3; ++axis) {
                batch.corner[corner][axis][lane] = at[axis];
            }
        }
    };
    for (std::size_t begin = 0; begin < m_within.size(); begin += batchWidth) {
        const std::size_t count = std::min<std::size_t>(batchWidth, m_within.size() - begin);
        for (int lane = 0; lane < batchWidth; ++lane) {
            const TrianglePair& pair = m_within[begin + std::min(static_cast<std::size_t>(lane), count - 1)];
            gather(first, lane, pair.triangleA);
            gather(second, lane, pair.triangleB);
        }
        signedDistances(first, second, found, distance);
        for (std::size_t lane = 0; lane < count; ++lane) {
            if (!(found.signedDistance[lane] <= distance)) {
                continue;
            }
            const TrianglePair& pair = m_within[begin + lane];
            if (near != nullptr &&
                areNeighbours(body.triangles[pair.triangleA], body.triangles[pair.triangleB], *near)) {
                continue;
            }
            if ((found.overlapping >> lane & 1U) != 0) {
                thin.push_back(pair);
                continue;
            }
            Candidate& candidate = m_candidates.emplace_back();
            candidate.place[0] = static_cast<std::int32_t>(tree.leafOfTriangle[pair.triangleA]);
            candidate.place[1] = static_cast<std::int32_t>(tree.leafOfTriangle[pair.triangleB]);
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const float middle = 0.5F * (found.onA[axis][lane] + found.onB[axis][lane]);
                candidate.place[2 + axis] =
                    static_cast<std::int32_t>(std::clamp(std::floor(middle / spacing), -1e9F, 1e9F));
            }
            candidate.distance = found.signedDistance[lane];
            candidate.pair = pair;
        }
    }
    std::ranges::sort(m_candidates, {}, [](const Candidate& c) {
        return std::tie(c.place, c.distance, c.pair.triangleA, c.pair.triangleB);
    });
    for (std::size_t i = 0; i < m_candidates.size(); ++i) {
        if (i == 0 || m_candidates[i].place != m_candidates[i - 1].place) {
            thin.push_back(m_candidates[i].pair);
        }
    }
    std::ranges::sort(thin);
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
