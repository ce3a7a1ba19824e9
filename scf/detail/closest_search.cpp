#include <grapeshot/scf/detail/closest_search.hpp>

#include <algorithm>
#include <bit>
#include <cmath>

namespace grapeshot::detail {
namespace {

constexpr float beyondEverything = 1e30F;  // m; finite, because unused lanes stand at infinity
constexpr int unitsOfDescent = 24;

struct FartherPieces {
    template <class Waiting>
    bool operator()(const Waiting& x, const Waiting& y) const {
        // Of those as near, leaves first: so few wait.
        return x.distance != y.distance ? x.distance > y.distance
               : x.pair.a != y.pair.a   ? x.pair.a < y.pair.a
                                        : x.pair.b < y.pair.b;
    }
};

float nearnessOf(const FeaturePair& pair) {
    return std::max(pair.signedDistance, 0.0F);
}

bool isFartherPair(const FeaturePair& x, const FeaturePair& y) {
    return nearnessOf(x) != nearnessOf(y) ? nearnessOf(x) > nearnessOf(y) : y.pair < x.pair;
}

}  // namespace

void ClosestSearch::begin(const PairSpace& space, const ClosestSettings& settings) {
    m_space = &space;
    m_settings = &settings;
    m_waiting.assign(1, {0, {0, 0}});
    m_found.clear();
    m_batch.clear();
    m_batch.forget();
    m_limit = std::min(settings.maxDistance, beyondEverything);
    m_isByCenters = false;
    m_atLeast = 0;
    m_work = 0;
}

void ClosestSearch::flush() {
    if (m_batch.size() == 0) {
        return;
    }
    ++m_work;
    const int count = m_batch.run(m_limit);
    for (int lane = 0; lane < count; ++lane) {
        const float distance = m_batch.out().signedDistance[lane];
        if (distance <= m_limit) {
            m_batch.describe(lane, m_found.emplace_back());
            std::push_heap(m_found.begin(), m_found.end(), isFartherPair);
            if (m_settings->most == 1) {
                m_limit = std::max(distance, 0.0F);
                m_isByCenters = false;
            }
        }
    }
}

void ClosestSearch::testFans(std::uint32_t vertexA, std::uint32_t vertexB) {
    for (const std::uint32_t a : m_space->a->tree().surface.fan.of(vertexA)) {
        for (const std::uint32_t b : m_space->b->tree().surface.fan.of(vertexB)) {
            m_batch.add(*m_space, {a, b});
            if (m_batch.isFull()) {
                flush();
            }
        }
    }
    flush();
}

void ClosestSearch::look(const TrianglePair& pair) {
    if (pair.triangleA >= m_space->a->tree().surface.triangles.size() ||
        pair.triangleB >= m_space->b->tree().surface.triangles.size() ||
        m_space->leavesOut(pair.triangleA, pair.triangleB)) {
        return;
    }
    m_batch.add(*m_space, pair);
    flush();
    // A list would have the pairs around this one twice.
    if (m_settings->most == 1 && !m_space->isSelf()) {
        const VertexPair corners = nearestCorners(*m_space, pair);
        const VertexPair nearest = descend(*m_space, corners.a, corners.b, unitsOfDescent, m_work);
        testFans(nearest.a, nearest.b);
    }
}

void ClosestSearch::boundByCenters(const FourBalls& a, const FourBalls& b, const ChildPairs& children,
                                   const float (&between)[16]) {
    if (m_settings->most > 1 || m_space->isSelf()) {
        return;  // one bound is not enough; they may be left out
    }
    for (std::uint32_t left = children.mask; left != 0U; left &= left - 1U) {
        const auto lane = static_cast<unsigned>(std::countr_zero(left));
        // The centres are vertices; a triangle's distance is rounded in proportion to its extent.
        const float bound = between[lane] + 1e-5F * (between[lane] + a.radius[lane >> 2U] + b.radius[lane & 3U]);
        if (bound < m_limit) {
            m_limit = bound;
            m_centers = {centerOf(m_space->a->tree(), children.a[lane >> 2U]),
                         centerOf(m_space->b->tree(), children.b[lane & 3U]), 0};
            m_isByCenters = true;
        }
    }
}

void ClosestSearch::openLeaves(std::uint32_t leafA, std::uint32_t leafB) {
    const PosedLeaf& a = m_space->a->leaf(leafA);
    const PosedLeaf& b = m_space->b->leaf(leafB);
    const bool same = m_space->isSelf() && leafA == leafB;
    std::uint16_t row[16];
    m_work += closeRows(a, b, m_limit, m_space->exclusion, row);
    const std::uint32_t* const trianglesA = m_space->a->tree().leaves[leafA].triangle;
    const std::uint32_t* const trianglesB = m_space->b->tree().leaves[leafB].triangle;
    for (unsigned i = 0; i < 16; ++i) {
        std::uint32_t left = same ? row[i] & ~((2U << i) - 1U) : row[i];
        for (; left != 0U; left &= left - 1U) {
            const auto j = static_cast<unsigned>(std::countr_zero(left));
            if (m_space->excludes(trianglesA[i], trianglesB[j])) {
                continue;
            }
            m_batch.add(*m_space, a, i, trianglesA[i], b, j, trianglesB[j]);
            if (m_batch.isFull()) {
                flush();
            }
        }
    }
    flush();
}

void ClosestSearch::open(const Waiting& pieces) {
    if (isBallLeaf(pieces.pair.a) && isBallLeaf(pieces.pair.b)) {
        openLeaves(ballIndex(pieces.pair.a), ballIndex(pieces.pair.b));
        return;
    }
    ChildPairs children;
    const OpenPiece<PosedTree, FourBalls> pieceA(*m_space->a, pieces.pair.a, false, m_space->isSelf(), children.a);
    const OpenPiece<PosedTree, FourBalls> pieceB(*m_space->b, pieces.pair.b, false, m_space->isSelf(), children.b);
    float gap[16];
    float between[16];
    ++m_work;
    gapsOfBalls(*pieceA.balls, *pieceB.balls, gap, between);
    children.mask = lanesOf(pieceA.count, pieceB.count);
    if (m_space->isSelf()) {
        ++m_work;
        children.mask &= pieces.pair.a == pieces.pair.b ? lanesOfOne : 0xffffU;
        children.mask &= ~ballsWithin(*pieceA.restBalls, *pieceB.restBalls, m_space->exclusion);
    }
    boundByCenters(*pieceA.balls, *pieceB.balls, children, between);
    for (std::uint32_t left = children.mask; left != 0U; left &= left - 1U) {
        const auto lane = static_cast<unsigned>(std::countr_zero(left));
        const float distance = std::max(gap[lane], pieces.distance);
        if (distance <= m_limit) {
            m_waiting.push_back({distance, children.at(lane)});
            std::push_heap(m_waiting.begin(), m_waiting.end(), FartherPieces());
        }
    }
}

/// The nearest that was found goes out, unless it is too near to one that has gone. True: it did.
bool ClosestSearch::emit(std::vector<FeaturePair>& out) {
    std::pop_heap(m_found.begin(), m_found.end(), isFartherPair);
    const FeaturePair nearest = m_found.back();
    m_found.pop_back();
    const float square = m_settings->spacing * m_settings->spacing;
    for (const FeaturePair& other : out) {
        if (other.pair == nearest.pair ||
            ((other.onA - nearest.onA).squaredNorm() < square && (other.onB - nearest.onB).squaredNorm() < square)) {
            return false;
        }
    }
    out.push_back(nearest);
    return true;
}

bool ClosestSearch::run(Meter& meter, std::vector<FeaturePair>& out) {
    while (out.size() < m_settings->most) {
        if (!m_waiting.empty() && m_waiting.front().distance > m_limit) {
            m_waiting.clear();
        }
        if (!m_found.empty() && (m_waiting.empty() || nearnessOf(m_found.front()) <= m_waiting.front().distance)) {
            emit(out);
            continue;
        }
        if (m_waiting.empty()) {
            if (!m_isByCenters) {
                m_atLeast = std::min(m_settings->maxDistance, beyondEverything);
                return true;
            }
            // Rounding has left out what the two vertices belong to.
            m_isByCenters = false;
            m_limit = std::min(m_settings->maxDistance, beyondEverything);
            testFans(m_centers.a, m_centers.b);
            continue;
        }
        if (meter.left(m_work) == 0) {
            m_atLeast = m_waiting.front().distance;
            while (!m_found.empty() && out.size() < m_settings->most) {
                emit(out);
            }
            return false;
        }
        const Waiting nearest = m_waiting.front();
        std::pop_heap(m_waiting.begin(), m_waiting.end(), FartherPieces());
        m_waiting.pop_back();
        open(nearest);
    }
    m_atLeast = nearnessOf(out.back());
    return true;
}

}  // namespace grapeshot::detail
