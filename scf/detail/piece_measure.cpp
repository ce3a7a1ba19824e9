#include <grapeshot/scf/detail/piece_measure.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

#include <grapeshot/scf/detail/sliced_vectors.hpp>

namespace grapeshot::detail {

Sliced PieceMeasure::prepare() {
    co_await m_geodesics.prepare();
    m_fromFirst.reserve(m_of.surface.rest.size());
    m_fromSecond.reserve(m_of.surface.rest.size());
    co_await fillInSlices(m_key, m_of.surface.triangles.size(), 0.0);
}

/// The vertex that is farthest from the middle: an end of the piece.
Sliced PieceMeasure::findFirstEnd(std::size_t& end) {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    const auto add = [&](std::size_t begin, std::size_t until) {
        for (std::size_t i = begin; i < until; ++i) {
            middle += m_of.surface.rest[m_of.vertices[i]].cast<double>();
        }
    };
    co_await inPieces(0, m_of.vertices.size(), verticesPerUnit, add);
    middle /= static_cast<double>(m_of.vertices.size());
    end = 0;
    double farthest = -1;
    const auto look = [&](std::size_t begin, std::size_t until) {
        for (std::size_t i = begin; i < until; ++i) {
            const double distance = (m_of.surface.rest[m_of.vertices[i]].cast<double>() - middle).squaredNorm();
            if (distance > farthest) {
                farthest = distance;
                end = i;
            }
        }
    };
    co_await inPieces(0, m_of.vertices.size(), verticesPerUnit, look);
}

Sliced PieceMeasure::findFarthest(const std::vector<double>& distance, std::size_t& farthest) {
    farthest = 0;
    const auto look = [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            farthest = distance[i] > distance[farthest] ? i : farthest;
        }
    };
    co_await inPieces(0, distance.size(), 4 * verticesPerUnit, look);
}

/// Distances from both ends of the piece, within it.
Sliced PieceMeasure::measureEnds(TriangleRange range) {
    co_await m_of.gather(range);
    co_await m_geodesics.setGoals(m_of.vertices);
    bool connected = false;
    std::size_t end = 0;
    co_await findFirstEnd(end);
    co_await m_geodesics.withinGoals(m_of.vertices[end], m_fromFirst, connected);
    co_await findFarthest(m_fromFirst, end);
    co_await m_geodesics.withinGoals(m_of.vertices[end], m_fromSecond, connected);
}

/// Where each triangle lies between the two ends.
Sliced PieceMeasure::rememberKeys(TriangleRange range) {
    m_keysOf = range;
    const auto remember = [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            double key = 0;
            for (const std::uint32_t v : m_of.surface.triangles[m_of.order[i]]) {
                key += m_fromFirst[m_of.place[v]] - m_fromSecond[m_of.place[v]];
            }
            m_key[m_of.order[i]] = key;
        }
    };
    co_await inPieces(range.begin, range.end, trianglesPerUnit, remember);
}

Sliced PieceMeasure::measureKeys(TriangleRange range) {
    if (m_keysOf != range) {
        co_await measureEnds(range);
        co_await rememberKeys(range);
    }
}

/// The best of two tries for the middle: as far from both ends, then also from what was farthest from the first.
Sliced PieceMeasure::putBallAround(TriangleRange range, PieceBall& best) {
    bool isOne = false;
    co_await m_of.askOnePiece(range, isOne);
    if (!isOne) {
        co_await m_of.gather(range);
        best = {m_of.vertices.front(), std::numeric_limits<float>::infinity(), 0};
        co_return;
    }
    co_await measureEnds(range);
    co_await rememberKeys(range);
    co_await takeFarther();
    co_await tryNearest(best);
    std::size_t corner = 0;
    bool connected = false;
    co_await findFarthest(m_fromSecond, corner);
    co_await m_geodesics.withinGoals(m_of.vertices[corner], m_fromSecond, connected);
    co_await takeFarther();
    PieceBall second;
    co_await tryNearest(second);
    best = second.radius < best.radius ? second : best;
}

Sliced PieceMeasure::takeFarther() {
    const auto take = [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            m_fromFirst[i] = std::max(m_fromFirst[i], m_fromSecond[i]);
        }
    };
    co_await inPieces(0, m_of.vertices.size(), 4 * verticesPerUnit, take);
}

/// Around the vertex that is nearest to all ends; leaves the distances from it in m_fromSecond.
Sliced PieceMeasure::tryNearest(PieceBall& ball) {
    std::size_t nearest = 0;
    const auto look = [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            nearest = m_fromFirst[i] < m_fromFirst[nearest] ? i : nearest;
        }
    };
    co_await inPieces(0, m_of.vertices.size(), 4 * verticesPerUnit, look);
    const std::uint32_t center = m_of.vertices[nearest];
    bool connected = false;
    double radius = 0;
    co_await m_geodesics.withinGoals(center, m_fromSecond, connected);
    if (connected) {
        std::size_t farthest = 0;
        co_await findFarthest(m_fromSecond, farthest);
        radius = m_fromSecond[farthest];
    } else {
        co_await m_geodesics.radiusNear(center, radius);
    }
    ball = {center, std::nextafter(static_cast<float>(radius), std::numeric_limits<float>::infinity()), 0};
}

/// Nearly the smallest: from the middle of the box in ever shorter steps towards what is farthest.
Sliced PieceMeasure::setPlainBall(TriangleRange range, PieceBall& own) {
    co_await m_of.gather(range);
    Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
    Eigen::Vector3d high = -low;
    const auto extend = [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            low = low.cwiseMin(m_of.surface.rest[m_of.vertices[i]].cast<double>());
            high = high.cwiseMax(m_of.surface.rest[m_of.vertices[i]].cast<double>());
        }
    };
    co_await inPieces(0, m_of.vertices.size(), verticesPerUnit, extend);
    Eigen::Vector3d center = (low + high) / 2;
    Eigen::Vector3d best = center;
    Eigen::Vector3d far = center;
    double square = -1;
    double radius = std::numeric_limits<double>::infinity();
    const auto look = [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const Eigen::Vector3d p = m_of.surface.rest[m_of.vertices[i]].cast<double>();
            const double distance = (p - center).squaredNorm();
            if (distance > square) {
                square = distance;
                far = p;
            }
        }
    };
    for (int i = 0; i < 24; ++i) {
        square = -1;
        co_await inPieces(0, m_of.vertices.size(), 2 * verticesPerUnit, look);
        if (const double now = std::sqrt(square); now < radius) {
            radius = now;
            best = center;
        }
        center += (far - center) / (i + 6);
    }
    for (int axis = 0; axis < 3; ++axis) {
        own.plainCenter[axis] = static_cast<float>(best[axis]);
    }
    // The centre was rounded.
    own.plainRadius = std::nextafter(static_cast<float>(radius + 0x1p-23 * best.cwiseAbs().maxCoeff()),
                                     std::numeric_limits<float>::infinity());
}

}  // namespace grapeshot::detail
