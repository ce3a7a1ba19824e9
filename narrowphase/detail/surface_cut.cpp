#include <grapeshot/narrowphase/detail/surface_cut.hpp>

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>
#include <utility>

#include <grapeshot/core/detail/point_grid.hpp>

namespace grapeshot::detail {
namespace {

// An area vector below this part of what the curve's length could enclose is that of an open curve, or of noise.
constexpr double leastRoundness = 0.01;

/// Half the sum of x cross dx about the cut's centre; the curve's length comes with it.
struct AreaVector {
    Eigen::Vector3d area = Eigen::Vector3d::Zero();
    double length = 0;
};

AreaVector areaVector(std::span<const CutPiece> pieces, const Eigen::Vector3d& center) {
    AreaVector sum;
    for (const CutPiece& piece : pieces) {
        if (piece.hasSegment) {
            const Eigen::Vector3d from = piece.segment.from - center;
            const Eigen::Vector3d to = piece.segment.to - center;
            sum.area += 0.5 * from.cross(to);
            sum.length += (to - from).norm();
        }
    }
    return sum;
}

Eigen::Vector3d normalOf(const MeshModel& a, const MeshModel& b, const Pose& bInA, std::span<const CutPiece> pieces,
                         const Eigen::Vector3d& center) {
    const AreaVector curve = areaVector(pieces, center);
    const double roundest = curve.length * curve.length / (4 * 3.141592653589793);
    if (curve.area.norm() > leastRoundness * roundest && roundest > 0) {
        return -curve.area.normalized();
    }
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    const Eigen::Matrix3d rotation = bInA.rotation.cast<double>();
    for (const CutPiece& piece : pieces) {
        sum += rotation * b.triangleNormals[piece.pair.triangleB].cast<double>() -
               a.triangleNormals[piece.pair.triangleA].cast<double>();
    }
    if (sum.norm() > 1e-3 * static_cast<double>(pieces.size())) {
        return sum.normalized();
    }
    // Two sheets back to back, say: any side is as good.
    const Eigen::Vector3d any = -a.triangleNormals[pieces.front().pair.triangleA].cast<double>();
    return any.norm() > 0.5 ? any.normalized() : Eigen::Vector3d::UnitY();
}

/// Union-find; the lowest index stands for its component.
class Partition {
  public:
    void reset(std::size_t count) {
        m_parent.resize(count);
        std::iota(m_parent.begin(), m_parent.end(), 0U);
    }
    [[nodiscard]] std::uint32_t find(std::uint32_t i) {
        while (m_parent[i] != i) {
            m_parent[i] = m_parent[m_parent[i]];
            i = m_parent[i];
        }
        return i;
    }
    void join(std::uint32_t i, std::uint32_t j) {
        i = find(i);
        j = find(j);
        m_parent[std::max(i, j)] = std::min(i, j);
    }

  private:
    std::vector<std::uint32_t> m_parent;
};

/// Neighbours on the curve end in the very same point: both compute it from the same edge and the same plane.
void joinAlongCurve(std::span<const CutPiece> pieces, Partition& partition) {
    using End = std::array<double, 3>;
    thread_local std::vector<std::pair<End, std::uint32_t>> ends;
    ends.clear();
    for (std::uint32_t i = 0; i < pieces.size(); ++i) {
        if (pieces[i].hasSegment) {
            for (const Eigen::Vector3d* end : {&pieces[i].segment.from, &pieces[i].segment.to}) {
                ends.push_back({{end->x(), end->y(), end->z()}, i});
            }
        }
    }
    std::sort(ends.begin(), ends.end());
    for (std::size_t i = 1; i < ends.size(); ++i) {
        if (ends[i].first == ends[i - 1].first) {
            partition.join(ends[i].second, ends[i - 1].second);
        }
    }
}

void joinNear(std::span<const CutPiece> pieces, float spacing, Partition& partition) {
    thread_local PointGrid grid;
    thread_local std::vector<std::uint32_t> open;
    thread_local std::vector<char> reached;
    const auto count = static_cast<std::uint32_t>(pieces.size());
    grid.reset(count, spacing);
    reached.assign(count, 0);
    for (std::uint32_t i = count; i-- > 0;) {
        grid.insert(i, pieces[i].middle);
    }
    for (std::uint32_t seed = 0; seed < count; ++seed) {
        if (reached[seed] != 0) {
            continue;
        }
        reached[seed] = 1;
        open.assign(1, seed);
        while (!open.empty()) {
            const std::uint32_t at = open.back();
            open.pop_back();
            grid.take(pieces[at].middle, [&](std::uint32_t other) {
                if (reached[other] != 0) {
                    return true;
                }
                if ((pieces[other].middle - pieces[at].middle).squaredNorm() > spacing * spacing) {
                    return false;
                }
                reached[other] = 1;
                partition.join(at, other);
                open.push_back(other);
                return true;
            });
        }
    }
}

}  // namespace

TriangleD cornersOf(const Tree& tree, std::uint32_t triangle) {
    const Triangle& corner = tree.triangles[triangle];
    return {tree.vertices[corner[0]].cast<double>(), tree.vertices[corner[1]].cast<double>(),
            tree.vertices[corner[2]].cast<double>()};
}

TriangleD cornersOf(const Tree& tree, std::uint32_t triangle, const Pose& pose) {
    const Eigen::Matrix3d rotation = pose.rotation.cast<double>();
    const Eigen::Vector3d translation = pose.translation.cast<double>();
    TriangleD corners = cornersOf(tree, triangle);
    for (Eigen::Vector3d& corner : corners) {
        corner = rotation * corner + translation;
    }
    return corners;
}

void findCuts(const MeshModel& a, const MeshModel& b, const Pose& bInA, std::span<const TriangleContact> pairs,
              float spacing, SurfaceCuts& out) {
    struct Scratch {
        std::vector<CutPiece> pieces;
        Partition partition;
        std::vector<std::pair<std::uint32_t, std::uint32_t>> order;  // component, piece
    };
    thread_local Scratch s;
    out.pieces.clear();
    out.cuts.clear();
    s.pieces.clear();
    for (const TriangleContact& contact : pairs) {
        if (!contact.overlapping || !contact.onA.allFinite()) {
            continue;
        }
        CutPiece& piece = s.pieces.emplace_back();
        piece.pair = contact.pair;
        piece.middle = contact.onA;
        piece.overlap = std::max(0.0F, -contact.signedDistance);
        if (const auto segment =
                cut(cornersOf(a.tree, contact.pair.triangleA), cornersOf(b.tree, contact.pair.triangleB, bInA))) {
            piece.segment = *segment;
            piece.hasSegment = true;
        }
    }
    s.partition.reset(s.pieces.size());
    joinAlongCurve(s.pieces, s.partition);
    joinNear(s.pieces, spacing, s.partition);
    s.order.clear();
    for (std::uint32_t i = 0; i < s.pieces.size(); ++i) {
        s.order.emplace_back(s.partition.find(i), i);
    }
    std::sort(s.order.begin(), s.order.end());
    for (std::size_t i = 0; i < s.order.size(); ++i) {
        if (i == 0 || s.order[i].first != s.order[i - 1].first) {
            out.cuts.emplace_back().begin = static_cast<std::uint32_t>(i);
        }
        out.pieces.push_back(s.pieces[s.order[i].second]);
        out.cuts.back().end = static_cast<std::uint32_t>(i + 1);
    }
    for (SurfaceCut& surfaceCut : out.cuts) {
        const auto pieces = out.piecesOf(surfaceCut);
        for (const CutPiece& piece : pieces) {
            surfaceCut.center += piece.middle.cast<double>() / static_cast<double>(pieces.size());
        }
        surfaceCut.normal = normalOf(a, b, bInA, pieces, surfaceCut.center);
    }
}

}  // namespace grapeshot::detail
