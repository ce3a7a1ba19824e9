#include <grapeshot/scf/ball_tree.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <grapeshot/scf/detail/geodesics.hpp>

namespace grapeshot {
namespace {

constexpr std::size_t leafSize = 16;

/// Lowest vertex index of the connected piece of each vertex.
std::vector<std::uint32_t> piecesOf(const Surface& surface) {
    std::vector<std::uint32_t> piece(surface.rest.size(), noBall);
    std::vector<std::uint32_t> open;
    for (std::uint32_t v = 0; v < piece.size(); ++v) {
        if (piece[v] != noBall) {
            continue;
        }
        piece[v] = v;
        open.push_back(v);
        while (!open.empty()) {
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
    return piece;
}

class Builder {
  public:
    explicit Builder(BallTree& tree)
        : m_tree(tree),
          m_surface(tree.surface),
          m_geodesics(tree.surface),
          m_piece(piecesOf(tree.surface)),
          m_order(tree.surface.triangles.size()),
          m_place(tree.surface.rest.size()),
          m_stamp(tree.surface.rest.size(), 0) {
        std::iota(m_order.begin(), m_order.end(), 0U);
        m_middle.reserve(m_order.size());
        for (const Triangle& t : m_surface.triangles) {
            m_middle.emplace_back((m_surface.rest[t[0]] + m_surface.rest[t[1]] + m_surface.rest[t[2]]) / 3);
        }
        m_key.resize(m_order.size());
    }

    void run() {
        m_tree.leafOfTriangle.resize(m_order.size());
        m_tree.leafVertices.begin.push_back(0);
        constexpr float infinity = std::numeric_limits<float>::infinity();
        const PieceBall root{m_surface.triangles[0][0], infinity, infinity};
        const Range all{0, static_cast<std::uint32_t>(m_order.size())};
        if (all.size() <= leafSize) {
            m_tree.nodes.push_back({});
            m_tree.nodes[0].own = root;
            m_tree.restBalls.push_back({});
            m_tree.plainBalls.push_back({});
            fillSlots(0, {all});
        } else {
            addNode(all, root);
        }
    }

  private:
    struct Range {
        std::uint32_t begin = 0, end = 0;
        [[nodiscard]] std::size_t size() const { return end - begin; }
    };

    std::uint32_t addNode(const Range& range, const PieceBall& own) {
        const auto index = static_cast<std::uint32_t>(m_tree.nodes.size());
        m_tree.nodes.push_back({});
        m_tree.nodes[index].own = own;
        m_tree.restBalls.push_back({});
        m_tree.plainBalls.push_back({});
        std::vector<Range> parts;
        for (const Range& half : split(range)) {
            if (half.size() <= leafSize) {
                parts.push_back(half);
            } else {
                const auto quarters = split(half);
                parts.insert(parts.end(), quarters.begin(), quarters.end());
            }
        }
        fillSlots(index, parts);
        return index;
    }

    void fillSlots(std::uint32_t index, const std::vector<Range>& parts) {
        for (std::size_t slot = 0; slot < 4; ++slot) {
            m_tree.nodes[index].center[slot] = 0;
            m_tree.nodes[index].radius[slot] = 0;
            m_tree.nodes[index].child[slot] = noBall;
        }
        m_tree.nodes[index].count = static_cast<std::uint32_t>(parts.size());
        for (std::size_t slot = 0; slot < parts.size(); ++slot) {
            PieceBall own = ballAround(parts[slot]);
            m_tree.nodes[index].center[slot] = own.center;
            m_tree.nodes[index].radius[slot] = own.radius;
            const Eigen::Vector3f& middle = m_surface.rest[own.center];
            float reach = 0;
            for (std::uint32_t i = parts[slot].begin; i < parts[slot].end; ++i) {
                reach = std::max(reach, (m_middle[m_order[i]] - middle).norm());
            }
            for (int axis = 0; axis < 3; ++axis) {
                m_tree.restBalls[index].center[axis][slot] = middle[axis];
            }
            own.restRadius = reach * 1.00001F;
            m_tree.restBalls[index].radius[slot] = own.restRadius;
            setPlainBall(parts[slot], own);
            for (int axis = 0; axis < 3; ++axis) {
                m_tree.plainBalls[index].center[axis][slot] = own.plainCenter[axis];
            }
            m_tree.plainBalls[index].radius[slot] = own.plainRadius;
            const BallRef child =
                parts[slot].size() <= leafSize ? addLeaf(parts[slot], own) : addNode(parts[slot], own);
            m_tree.nodes[index].child[slot] = child;
        }
    }

    /// Nearly the smallest: from the middle of the box in ever shorter steps towards what is farthest.
    void setPlainBall(const Range& range, PieceBall& own) {
        gather(range);
        Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
        Eigen::Vector3d high = -low;
        for (const std::uint32_t v : m_vertices) {
            low = low.cwiseMin(m_surface.rest[v].cast<double>());
            high = high.cwiseMax(m_surface.rest[v].cast<double>());
        }
        const auto farthestFrom = [&](const Eigen::Vector3d& center, Eigen::Vector3d& point) {
            double square = -1;
            for (const std::uint32_t v : m_vertices) {
                const Eigen::Vector3d p = m_surface.rest[v].cast<double>();
                const double distance = (p - center).squaredNorm();
                if (distance > square) {
                    square = distance;
                    point = p;
                }
            }
            return std::sqrt(square);
        };
        Eigen::Vector3d center = (low + high) / 2;
        Eigen::Vector3d best = center;
        Eigen::Vector3d far = center;
        double radius = std::numeric_limits<double>::infinity();
        for (int i = 0; i < 24; ++i) {
            const double now = farthestFrom(center, far);
            if (now < radius) {
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

    BallRef addLeaf(const Range& range, const PieceBall& own) {
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
        const std::vector<std::uint32_t>& vertices = gather(range);
        m_tree.leafVertices.all.insert(m_tree.leafVertices.all.end(), vertices.begin(), vertices.end());
        m_tree.leafVertices.begin.push_back(static_cast<std::uint32_t>(m_tree.leafVertices.all.size()));
        return index | ballLeafBit;
    }

    /// Distinct corners of the triangles.
    const std::vector<std::uint32_t>& gather(const Range& range) {
        ++m_round;
        m_vertices.clear();
        for (std::uint32_t i = range.begin; i < range.end; ++i) {
            for (const std::uint32_t v : m_surface.triangles[m_order[i]]) {
                if (m_stamp[v] != m_round) {
                    m_stamp[v] = m_round;
                    m_place[v] = static_cast<std::uint32_t>(m_vertices.size());
                    m_vertices.push_back(v);
                }
            }
        }
        return m_vertices;
    }

    [[nodiscard]] std::uint32_t pieceOf(std::uint32_t order) const {
        return m_piece[m_surface.triangles[m_order[order]][0]];
    }
    [[nodiscard]] bool isOnePiece(const Range& range) const {
        for (std::uint32_t i = range.begin + 1; i < range.end; ++i) {
            if (pieceOf(i) != pieceOf(range.begin)) {
                return false;
            }
        }
        return true;
    }

    std::vector<Range> split(const Range& range) { return isOnePiece(range) ? splitAlong(range) : splitPieces(range); }

    /// The vertex that is farthest from the middle: an end of the piece.
    std::size_t firstEnd() const {
        Eigen::Vector3d middle = Eigen::Vector3d::Zero();
        for (const std::uint32_t v : m_vertices) {
            middle += m_surface.rest[v].cast<double>();
        }
        middle /= static_cast<double>(m_vertices.size());
        std::size_t end = 0;
        double farthest = -1;
        for (std::size_t i = 0; i < m_vertices.size(); ++i) {
            const double distance = (m_surface.rest[m_vertices[i]].cast<double>() - middle).squaredNorm();
            if (distance > farthest) {
                farthest = distance;
                end = i;
            }
        }
        return end;
    }

    static std::size_t farthestOf(const std::vector<double>& distance) {
        return static_cast<std::size_t>(std::max_element(distance.begin(), distance.end()) - distance.begin());
    }

    /// Distances from both ends of the piece, within it.
    void measureEnds(const Range& range) {
        gather(range);
        m_geodesics.setGoals(m_vertices);
        m_geodesics.withinGoals(m_vertices[firstEnd()], m_fromFirst);
        m_geodesics.withinGoals(m_vertices[farthestOf(m_fromFirst)], m_fromSecond);
    }

    /// Where each triangle lies between the two ends.
    void rememberKeys(const Range& range) {
        m_keysOf = range;
        for (std::uint32_t i = range.begin; i < range.end; ++i) {
            double key = 0;
            for (const std::uint32_t v : m_surface.triangles[m_order[i]]) {
                key += m_fromFirst[m_place[v]] - m_fromSecond[m_place[v]];
            }
            m_key[m_order[i]] = key;
        }
    }

    /// Half of the leaves on either side, all but one of them full.
    std::vector<Range> splitAlong(const Range& range) {
        if (m_keysOf.begin != range.begin || m_keysOf.end != range.end) {
            measureEnds(range);
            rememberKeys(range);
        }
        const std::size_t leaves = (range.size() + leafSize - 1) / leafSize;
        const auto middle = range.begin + static_cast<std::uint32_t>(leaves / 2 * leafSize);
        std::nth_element(
            m_order.begin() + range.begin, m_order.begin() + middle, m_order.begin() + range.end,
            [&](std::uint32_t a, std::uint32_t b) { return m_key[a] != m_key[b] ? m_key[a] < m_key[b] : a < b; });
        return {{range.begin, middle}, {middle, range.end}};
    }

    struct Piece {
        std::uint32_t id;
        std::uint32_t triangles = 0;
        Eigen::Vector3d middle = Eigen::Vector3d::Zero();
        double key = 0;
    };

    /// Whole pieces to either side, as evenly as they allow.
    std::vector<Range> splitPieces(const Range& range) {
        const auto begin = m_order.begin() + range.begin;
        const auto end = m_order.begin() + range.end;
        std::sort(begin, end, [&](std::uint32_t a, std::uint32_t b) {
            const std::uint32_t pieceA = m_piece[m_surface.triangles[a][0]];
            const std::uint32_t pieceB = m_piece[m_surface.triangles[b][0]];
            return pieceA != pieceB ? pieceA < pieceB : a < b;
        });
        std::vector<Piece> pieces;
        for (std::uint32_t i = range.begin; i < range.end; ++i) {
            if (pieces.empty() || pieces.back().id != pieceOf(i)) {
                pieces.push_back({pieceOf(i)});
            }
            ++pieces.back().triangles;
            pieces.back().middle += m_middle[m_order[i]].cast<double>();
        }
        Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
        Eigen::Vector3d high = -low;
        for (Piece& piece : pieces) {
            piece.middle /= piece.triangles;
            low = low.cwiseMin(piece.middle);
            high = high.cwiseMax(piece.middle);
        }
        int axis = 0;
        (high - low).maxCoeff(&axis);
        for (Piece& piece : pieces) {
            piece.key = piece.middle[axis];
        }
        std::sort(pieces.begin(), pieces.end(),
                  [](const Piece& a, const Piece& b) { return a.key != b.key ? a.key < b.key : a.id < b.id; });
        std::uint32_t left = 0;
        std::size_t cut = 0;
        while (cut + 1 < pieces.size() && (cut == 0 || 2 * left + pieces[cut].triangles <= range.size())) {
            left += pieces[cut++].triangles;
        }
        std::vector<std::uint32_t> onTheLeft;
        for (std::size_t i = 0; i < cut; ++i) {
            onTheLeft.push_back(pieces[i].id);
        }
        std::sort(onTheLeft.begin(), onTheLeft.end());
        std::stable_partition(begin, end, [&](std::uint32_t t) {
            return std::binary_search(onTheLeft.begin(), onTheLeft.end(), m_piece[m_surface.triangles[t][0]]);
        });
        return {{range.begin, range.begin + left}, {range.begin + left, range.end}};
    }

    /// The best of two tries for the middle: as far from both ends, then also from what was farthest from the first.
    PieceBall ballAround(const Range& range) {
        if (!isOnePiece(range)) {
            gather(range);
            return {m_vertices.front(), std::numeric_limits<float>::infinity(), 0};
        }
        measureEnds(range);
        rememberKeys(range);
        for (std::size_t i = 0; i < m_vertices.size(); ++i) {
            m_fromFirst[i] = std::max(m_fromFirst[i], m_fromSecond[i]);
        }
        PieceBall best = tryNearest();
        const std::uint32_t corner = m_vertices[farthestOf(m_fromSecond)];
        m_geodesics.withinGoals(corner, m_fromSecond);
        for (std::size_t i = 0; i < m_vertices.size(); ++i) {
            m_fromFirst[i] = std::max(m_fromFirst[i], m_fromSecond[i]);
        }
        const PieceBall second = tryNearest();
        return second.radius < best.radius ? second : best;
    }

    /// Around the vertex that is nearest to all ends; leaves the distances from it in m_fromSecond.
    PieceBall tryNearest() {
        const auto nearest = std::min_element(m_fromFirst.begin(), m_fromFirst.end()) - m_fromFirst.begin();
        const std::uint32_t center = m_vertices[static_cast<std::size_t>(nearest)];
        const double radius = m_geodesics.withinGoals(center, m_fromSecond) ? m_fromSecond[farthestOf(m_fromSecond)]
                                                                            : m_geodesics.radiusNear(center);
        return {center, std::nextafter(static_cast<float>(radius), std::numeric_limits<float>::infinity()), 0};
    }

    BallTree& m_tree;
    const Surface& m_surface;
    detail::Geodesics m_geodesics;
    std::vector<std::uint32_t> m_piece;
    std::vector<std::uint32_t> m_order;  ///< triangles; those of a piece of the tree stand together
    std::vector<Eigen::Vector3f> m_middle;
    std::vector<double> m_key;
    Range m_keysOf;  ///< whose keys they are
    std::vector<std::uint32_t> m_vertices, m_place, m_stamp;
    std::uint32_t m_round = 0;
    std::vector<double> m_fromFirst, m_fromSecond;
};

}  // namespace

BallTree buildBallTree(MeshView rest) {
    BallTree tree;
    tree.surface = makeSurface(rest);
    Builder(tree).run();
    for (const Eigen::Vector3f& vertex : tree.surface.rest) {
        tree.extent = std::max(tree.extent, vertex.norm());
    }
    return tree;
}

}  // namespace grapeshot
