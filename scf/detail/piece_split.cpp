#include <grapeshot/scf/detail/piece_split.hpp>

#include <algorithm>
#include <functional>
#include <limits>

#include <grapeshot/core/detail/sliced_sort.hpp>
#include <grapeshot/scf/detail/sliced_selection.hpp>

namespace grapeshot::detail {
namespace {

struct Piece {
    std::uint32_t id;
    std::uint32_t triangles = 0;
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    double key = 0;
};

}  // namespace

Sliced PieceSplit::split(TriangleRange range, std::vector<TriangleRange>& parts) {
    bool isOne = false;
    co_await m_of.askOnePiece(range, isOne);
    if (isOne) {
        co_await splitAlong(range, parts);
    } else {
        co_await splitPieces(range, parts);
    }
}

Sliced PieceSplit::splitAlong(TriangleRange range, std::vector<TriangleRange>& parts) {
    co_await m_measure.measureKeys(range);
    const std::vector<double>& key = m_measure.keys();
    const std::size_t leaves = (range.size() + ballLeafSize - 1) / ballLeafSize;
    const auto middle = range.begin + static_cast<std::uint32_t>(leaves / 2 * ballLeafSize);
    co_await selectSliced(m_of.order, range.begin, middle, range.end,
                          [&](std::uint32_t a, std::uint32_t b) { return key[a] != key[b] ? key[a] < key[b] : a < b; });
    parts = {{range.begin, middle}, {middle, range.end}};
}

Sliced PieceSplit::splitPieces(TriangleRange range, std::vector<TriangleRange>& parts) {
    co_await sortSliced(m_of.order, range.begin, range.end, m_spare, [&](std::uint32_t a, std::uint32_t b) {
        const std::uint32_t pieceA = m_of.piece[m_of.surface.triangles[a][0]];
        const std::uint32_t pieceB = m_of.piece[m_of.surface.triangles[b][0]];
        return pieceA != pieceB ? pieceA < pieceB : a < b;
    });
    std::vector<Piece> pieces;
    const auto list = [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            if (pieces.empty() || pieces.back().id != m_of.pieceAt(i)) {
                pieces.push_back({m_of.pieceAt(i)});
            }
            ++pieces.back().triangles;
            pieces.back().middle += m_of.middle[m_of.order[i]].cast<double>();
        }
    };
    co_await inPieces(range.begin, range.end, trianglesPerUnit, list);
    Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
    Eigen::Vector3d high = -low;
    const auto extend = [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            pieces[i].middle /= pieces[i].triangles;
            low = low.cwiseMin(pieces[i].middle);
            high = high.cwiseMax(pieces[i].middle);
        }
    };
    co_await inPieces(0, pieces.size(), trianglesPerUnit, extend);
    int axis = 0;
    (high - low).maxCoeff(&axis);
    const auto key = [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            pieces[i].key = pieces[i].middle[axis];
        }
    };
    co_await inPieces(0, pieces.size(), verticesPerUnit, key);
    std::vector<Piece> spare;
    co_await sortSliced(pieces, 0, pieces.size(), spare,
                        [](const Piece& a, const Piece& b) { return a.key != b.key ? a.key < b.key : a.id < b.id; });
    std::uint32_t left = 0;
    std::size_t cut = 0;
    std::vector<std::uint32_t> onTheLeft;
    while (cut + 1 < pieces.size() && (cut == 0 || 2 * left + pieces[cut].triangles <= range.size())) {
        if (cut % verticesPerUnit == 0) {
            co_yield 1;
        }
        onTheLeft.push_back(pieces[cut].id);
        left += pieces[cut++].triangles;
    }
    co_await sortSliced(onTheLeft, 0, onTheLeft.size(), m_spare, std::less<>{});
    // Those on the left first, else as they are.
    m_spare.clear();
    std::size_t to = range.begin;
    const auto part = [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const std::uint32_t t = m_of.order[i];
            if (std::binary_search(onTheLeft.begin(), onTheLeft.end(), m_of.piece[m_of.surface.triangles[t][0]])) {
                m_of.order[to++] = t;
            } else {
                m_spare.push_back(t);
            }
        }
    };
    co_await inPieces(range.begin, range.end, trianglesPerUnit / 2, part);
    const auto putBack = [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            m_of.order[to++] = m_spare[i];
        }
    };
    co_await inPieces(0, m_spare.size(), 4 * verticesPerUnit, putBack);
    parts = {{range.begin, range.begin + left}, {range.begin + left, range.end}};
}

}  // namespace grapeshot::detail
