#include <grapeshot/scf/ball_tree_builder.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include <grapeshot/core/detail/sliced_sort.hpp>
#include <grapeshot/scf/detail/geodesics.hpp>
#include <grapeshot/scf/detail/sliced_selection.hpp>
#include <grapeshot/scf/detail/sliced_vectors.hpp>

namespace grapeshot {
namespace {

constexpr std::size_t leafSize = 16;
// Of each, per work unit.
constexpr std::size_t trianglesPerUnit = 12;
constexpr std::size_t verticesPerUnit = 32;
constexpr std::size_t visitsPerUnit = 4;

/// Lowest vertex index of the connected piece of each vertex.
Sliced findPieces(const Surface& surface, std::vector<std::uint32_t>& piece) {
    co_await detail::fillInSlices(piece, surface.rest.size(), noBall);
    std::vector<std::uint32_t> open;
    std::size_t visits = 0;
    for (std::uint32_t v = 0; v < piece.size(); ++v) {
        if (v % 256 == 0) {
            co_yield 2;
        }
        if (piece[v] != noBall) {
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
                if (piece[other] == noBall) {
                    piece[other] = v;
                    open.push_back(other);
                }
            }
        }
    }
}

/// In the order of a recursion, every step of which says what it costs.
class Builder {
  public:
    explicit Builder(BallTree& tree) : m_tree(tree), m_surface(tree.surface), m_geodesics(tree.surface) {}

    Sliced run() {
        co_await prepare();
        m_tree.leafVertices.begin.push_back(0);
        constexpr float infinity = std::numeric_limits<float>::infinity();
        const PieceBall root{m_surface.triangles[0][0], infinity, infinity};
        const Range all{0, static_cast<std::uint32_t>(m_order.size())};
        if (all.size() <= leafSize) {
            std::vector<Range> whole(1, all);
            co_await fillSlots(newNode(root), std::move(whole));
        } else {
            BallRef ignored = noBall;
            co_await addNode(all, root, ignored);
        }
    }

  private:
    struct Range {
        std::uint32_t begin = 0, end = 0;
        [[nodiscard]] std::size_t size() const { return end - begin; }
    };

    Sliced prepare() {
        co_await m_geodesics.prepare();
        co_await findPieces(m_surface, m_piece);
        const std::size_t triangles = m_surface.triangles.size();
        // What grows would be copied in one piece. Of a mesh in one piece all leaves are full but one.
        const std::size_t leaves = (triangles + leafSize - 1) / leafSize;
        m_tree.leaves.reserve(leaves);
        m_tree.leafVertices.begin.reserve(leaves + 1);
        m_tree.leafVertices.all.reserve(triangles);
        m_tree.nodes.reserve(leaves / 2 + 1);
        m_tree.restBalls.reserve(leaves / 2 + 1);
        m_tree.plainBalls.reserve(leaves / 2 + 1);
        m_vertices.reserve(m_surface.rest.size());
        m_fromFirst.reserve(m_surface.rest.size());
        m_fromSecond.reserve(m_surface.rest.size());
        m_order.reserve(triangles);
        m_middle.reserve(triangles);
        const auto list = [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                const Triangle& t = m_surface.triangles[i];
                m_order.push_back(static_cast<std::uint32_t>(i));
                m_middle.emplace_back((m_surface.rest[t[0]] + m_surface.rest[t[1]] + m_surface.rest[t[2]]) / 3);
            }
        };
        co_await inPieces(0, triangles, trianglesPerUnit, list);
        co_await detail::fillInSlices(m_key, triangles, 0.0);
        co_await detail::fillInSlices(m_place, m_surface.rest.size(), 0U);
        co_await detail::fillInSlices(m_stamp, m_surface.rest.size(), 0U);
        co_await detail::fillInSlices(m_tree.leafOfTriangle, triangles, 0U);
    }

    std::uint32_t newNode(const PieceBall& own) {
        const auto index = static_cast<std::uint32_t>(m_tree.nodes.size());
        m_tree.nodes.push_back({});
        m_tree.nodes[index].own = own;
        m_tree.restBalls.push_back({});
        m_tree.plainBalls.push_back({});
        return index;
    }

    Sliced addNode(Range range, PieceBall own, BallRef& made) {
        const std::uint32_t index = newNode(own);
        std::vector<Range> halves;
        std::vector<Range> parts;
        co_await split(range, halves);
        for (const Range& half : halves) {
            if (half.size() <= leafSize) {
                parts.push_back(half);
            } else {
                std::vector<Range> quarters;
                co_await split(half, quarters);
                parts.insert(parts.end(), quarters.begin(), quarters.end());
            }
        }
        co_await fillSlots(index, std::move(parts));
        made = index;
    }

    Sliced fillSlots(std::uint32_t index, std::vector<Range> parts) {
        for (std::size_t slot = 0; slot < 4; ++slot) {
            m_tree.nodes[index].center[slot] = 0;
            m_tree.nodes[index].radius[slot] = 0;
            m_tree.nodes[index].child[slot] = noBall;
        }
        m_tree.nodes[index].count = static_cast<std::uint32_t>(parts.size());
        for (std::size_t slot = 0; slot < parts.size(); ++slot) {
            const Range part = parts[slot];
            PieceBall own;
            co_await putBallAround(part, own);
            m_tree.nodes[index].center[slot] = own.center;
            m_tree.nodes[index].radius[slot] = own.radius;
            const Eigen::Vector3f middle = m_surface.rest[own.center];
            float reach = 0;
            const auto measure = [&](std::size_t begin, std::size_t end) {
                for (std::size_t i = begin; i < end; ++i) {
                    reach = std::max(reach, (m_middle[m_order[i]] - middle).norm());
                }
            };
            co_await inPieces(part.begin, part.end, verticesPerUnit, measure);
            for (int axis = 0; axis < 3; ++axis) {
                m_tree.restBalls[index].center[axis][slot] = middle[axis];
            }
            own.restRadius = reach * 1.00001F;
            m_tree.restBalls[index].radius[slot] = own.restRadius;
            co_await setPlainBall(part, own);
            for (int axis = 0; axis < 3; ++axis) {
                m_tree.plainBalls[index].center[axis][slot] = own.plainCenter[axis];
            }
            m_tree.plainBalls[index].radius[slot] = own.plainRadius;
            BallRef child = noBall;
            if (part.size() <= leafSize) {
                co_await addLeaf(part, own, child);
            } else {
                co_await addNode(part, own, child);
            }
            m_tree.nodes[index].child[slot] = child;
        }
    }

    /// Nearly the smallest: from the middle of the box in ever shorter steps towards what is farthest.
    Sliced setPlainBall(Range range, PieceBall& own) {
        co_await gather(range);
        Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
        Eigen::Vector3d high = -low;
        const auto extend = [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                low = low.cwiseMin(m_surface.rest[m_vertices[i]].cast<double>());
                high = high.cwiseMax(m_surface.rest[m_vertices[i]].cast<double>());
            }
        };
        co_await inPieces(0, m_vertices.size(), verticesPerUnit, extend);
        Eigen::Vector3d center = (low + high) / 2;
        Eigen::Vector3d best = center;
        Eigen::Vector3d far = center;
        double square = -1;
        double radius = std::numeric_limits<double>::infinity();
        const auto look = [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                const Eigen::Vector3d p = m_surface.rest[m_vertices[i]].cast<double>();
                const double distance = (p - center).squaredNorm();
                if (distance > square) {
                    square = distance;
                    far = p;
                }
            }
        };
        for (int i = 0; i < 24; ++i) {
            square = -1;
            co_await inPieces(0, m_vertices.size(), 2 * verticesPerUnit, look);
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

    Sliced addLeaf(Range range, PieceBall own, BallRef& made) {
        co_yield 6;
        const auto index = static_cast<std::uint32_t>(m_tree.leaves.size());
        // In the caller's order: neighbours in memory are then likelier neighbours here.
        std::sort(m_order.begin() + range.begin, m_order.begin() + range.end);
        BallLeaf leaf{};
        leaf.own = own;
        leaf.count = static_cast<std::uint32_t>(range.size());
        for (std::size_t lane = 0; lane < leafSize; ++lane) {
            const bool used = lane < range.size();
            const std::uint32_t t = m_order[range.begin + (used ? lane : 0)];
            leaf.triangle[lane] = used ? t : noTriangle;
            for (std::size_t corner = 0; corner < 3; ++corner) {
                leaf.corner[corner][lane] = m_surface.triangles[t][corner];
            }
            for (int axis = 0; axis < 3; ++axis) {
                leaf.middle[axis][lane] = m_middle[t][axis];
            }
            if (used) {
                m_tree.leafOfTriangle[t] = index;
            }
        }
        m_tree.leaves.push_back(leaf);
        co_await gather(range);
        m_tree.leafVertices.all.insert(m_tree.leafVertices.all.end(), m_vertices.begin(), m_vertices.end());
        m_tree.leafVertices.begin.push_back(static_cast<std::uint32_t>(m_tree.leafVertices.all.size()));
        made = index | ballLeafBit;
    }

    /// Distinct corners of the triangles, in m_vertices.
    Sliced gather(Range range) {
        ++m_round;
        m_vertices.clear();
        const auto list = [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                for (const std::uint32_t v : m_surface.triangles[m_order[i]]) {
                    if (m_stamp[v] != m_round) {
                        m_stamp[v] = m_round;
                        m_place[v] = static_cast<std::uint32_t>(m_vertices.size());
                        m_vertices.push_back(v);
                    }
                }
            }
        };
        co_await inPieces(range.begin, range.end, trianglesPerUnit, list);
    }

    [[nodiscard]] std::uint32_t pieceOf(std::size_t order) const {
        return m_piece[m_surface.triangles[m_order[order]][0]];
    }
    Sliced askOnePiece(Range range, bool& isOne) {
        isOne = true;
        const auto compare = [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end && isOne; ++i) {
                isOne = pieceOf(i) == pieceOf(range.begin);
            }
        };
        co_await inPieces(range.begin + 1, range.end, verticesPerUnit, compare);
    }

    Sliced split(Range range, std::vector<Range>& parts) {
        bool isOne = false;
        co_await askOnePiece(range, isOne);
        if (isOne) {
            co_await splitAlong(range, parts);
        } else {
            co_await splitPieces(range, parts);
        }
    }

    /// The vertex that is farthest from the middle: an end of the piece.
    Sliced findFirstEnd(std::size_t& end) {
        Eigen::Vector3d middle = Eigen::Vector3d::Zero();
        const auto add = [&](std::size_t begin, std::size_t until) {
            for (std::size_t i = begin; i < until; ++i) {
                middle += m_surface.rest[m_vertices[i]].cast<double>();
            }
        };
        co_await inPieces(0, m_vertices.size(), verticesPerUnit, add);
        middle /= static_cast<double>(m_vertices.size());
        end = 0;
        double farthest = -1;
        const auto look = [&](std::size_t begin, std::size_t until) {
            for (std::size_t i = begin; i < until; ++i) {
                const double distance = (m_surface.rest[m_vertices[i]].cast<double>() - middle).squaredNorm();
                if (distance > farthest) {
                    farthest = distance;
                    end = i;
                }
            }
        };
        co_await inPieces(0, m_vertices.size(), verticesPerUnit, look);
    }

    Sliced findFarthest(const std::vector<double>& distance, std::size_t& farthest) {
        farthest = 0;
        const auto look = [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                farthest = distance[i] > distance[farthest] ? i : farthest;
            }
        };
        co_await inPieces(0, distance.size(), 4 * verticesPerUnit, look);
    }

    /// Distances from both ends of the piece, within it.
    Sliced measureEnds(Range range) {
        co_await gather(range);
        co_await m_geodesics.setGoals(m_vertices);
        bool connected = false;
        std::size_t end = 0;
        co_await findFirstEnd(end);
        co_await m_geodesics.withinGoals(m_vertices[end], m_fromFirst, connected);
        co_await findFarthest(m_fromFirst, end);
        co_await m_geodesics.withinGoals(m_vertices[end], m_fromSecond, connected);
    }

    /// Where each triangle lies between the two ends.
    Sliced rememberKeys(Range range) {
        m_keysOf = range;
        const auto remember = [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                double key = 0;
                for (const std::uint32_t v : m_surface.triangles[m_order[i]]) {
                    key += m_fromFirst[m_place[v]] - m_fromSecond[m_place[v]];
                }
                m_key[m_order[i]] = key;
            }
        };
        co_await inPieces(range.begin, range.end, trianglesPerUnit, remember);
    }

    /// Half of the leaves on either side, all but one of them full.
    Sliced splitAlong(Range range, std::vector<Range>& parts) {
        if (m_keysOf.begin != range.begin || m_keysOf.end != range.end) {
            co_await measureEnds(range);
            co_await rememberKeys(range);
        }
        const std::size_t leaves = (range.size() + leafSize - 1) / leafSize;
        const auto middle = range.begin + static_cast<std::uint32_t>(leaves / 2 * leafSize);
        co_await detail::selectSliced(m_order, range.begin, middle, range.end, [&](std::uint32_t a, std::uint32_t b) {
            return m_key[a] != m_key[b] ? m_key[a] < m_key[b] : a < b;
        });
        parts = {{range.begin, middle}, {middle, range.end}};
    }

    struct Piece {
        std::uint32_t id;
        std::uint32_t triangles = 0;
        Eigen::Vector3d middle = Eigen::Vector3d::Zero();
        double key = 0;
    };

    /// Whole pieces to either side, as evenly as they allow.
    Sliced splitPieces(Range range, std::vector<Range>& parts) {
        co_await detail::sortSliced(m_order, range.begin, range.end, m_spare, [&](std::uint32_t a, std::uint32_t b) {
            const std::uint32_t pieceA = m_piece[m_surface.triangles[a][0]];
            const std::uint32_t pieceB = m_piece[m_surface.triangles[b][0]];
            return pieceA != pieceB ? pieceA < pieceB : a < b;
        });
        std::vector<Piece> pieces;
        const auto list = [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                if (pieces.empty() || pieces.back().id != pieceOf(i)) {
                    pieces.push_back({pieceOf(i)});
                }
                ++pieces.back().triangles;
                pieces.back().middle += m_middle[m_order[i]].cast<double>();
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
        co_await detail::sortSliced(pieces, 0, pieces.size(), spare, [](const Piece& a, const Piece& b) {
            return a.key != b.key ? a.key < b.key : a.id < b.id;
        });
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
        co_await detail::sortSliced(onTheLeft, 0, onTheLeft.size(), m_spare, std::less<>{});
        // Those on the left first, else as they are.
        m_spare.clear();
        std::size_t to = range.begin;
        const auto part = [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                const std::uint32_t t = m_order[i];
                if (std::binary_search(onTheLeft.begin(), onTheLeft.end(), m_piece[m_surface.triangles[t][0]])) {
                    m_order[to++] = t;
                } else {
                    m_spare.push_back(t);
                }
            }
        };
        co_await inPieces(range.begin, range.end, trianglesPerUnit / 2, part);
        const auto putBack = [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                m_order[to++] = m_spare[i];
            }
        };
        co_await inPieces(0, m_spare.size(), 4 * verticesPerUnit, putBack);
        parts = {{range.begin, range.begin + left}, {range.begin + left, range.end}};
    }

    /// The best of two tries for the middle: as far from both ends, then also from what was farthest from the first.
    Sliced putBallAround(Range range, PieceBall& best) {
        bool isOne = false;
        co_await askOnePiece(range, isOne);
        if (!isOne) {
            co_await gather(range);
            best = {m_vertices.front(), std::numeric_limits<float>::infinity(), 0};
            co_return;
        }
        co_await measureEnds(range);
        co_await rememberKeys(range);
        co_await takeFarther();
        co_await tryNearest(best);
        std::size_t corner = 0;
        bool connected = false;
        co_await findFarthest(m_fromSecond, corner);
        co_await m_geodesics.withinGoals(m_vertices[corner], m_fromSecond, connected);
        co_await takeFarther();
        PieceBall second;
        co_await tryNearest(second);
        best = second.radius < best.radius ? second : best;
    }

    Sliced takeFarther() {
        const auto take = [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                m_fromFirst[i] = std::max(m_fromFirst[i], m_fromSecond[i]);
            }
        };
        co_await inPieces(0, m_vertices.size(), 4 * verticesPerUnit, take);
    }

    /// Around the vertex that is nearest to all ends; leaves the distances from it in m_fromSecond.
    Sliced tryNearest(PieceBall& ball) {
        std::size_t nearest = 0;
        const auto look = [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                nearest = m_fromFirst[i] < m_fromFirst[nearest] ? i : nearest;
            }
        };
        co_await inPieces(0, m_vertices.size(), 4 * verticesPerUnit, look);
        const std::uint32_t center = m_vertices[nearest];
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

    BallTree& m_tree;
    const Surface& m_surface;
    detail::Geodesics m_geodesics;
    std::vector<std::uint32_t> m_piece;
    std::vector<std::uint32_t> m_order;  ///< triangles; those of a piece of the tree stand together
    std::vector<Eigen::Vector3f> m_middle;
    std::vector<double> m_key;
    Range m_keysOf;  ///< whose keys they are
    std::vector<std::uint32_t> m_vertices, m_place, m_stamp, m_spare;
    std::uint32_t m_round = 0;
    std::vector<double> m_fromFirst, m_fromSecond;
};

}  // namespace

Sliced buildBallTreeInSlices(MeshView rest, BallTree& tree) {
    co_await makeSurfaceInSlices(rest, tree.surface);
    Builder builder(tree);
    co_await builder.run();
    const auto measure = [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v) {
            tree.extent = std::max(tree.extent, tree.surface.rest[v].norm());
        }
    };
    co_await inPieces(0, tree.surface.rest.size(), verticesPerUnit, measure);
}

BallTree buildBallTree(MeshView rest) {
    BallTree tree;
    buildBallTreeInSlices(rest, tree).run();
    return tree;
}

}  // namespace grapeshot
