#include <grapeshot/narrowphase/detail/surface_cut.hpp>

#include <Eigen/Geometry>

#include <grapeshot/narrowphase/detail/point_grid.hpp>

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
        std::vector<std::uint32_t> overlapping;
        std::vector<char> taken;
        std::vector<std::uint32_t> queue;
        PointGrid grid;
    };
    thread_local Scratch s;
    out.pieces.clear();
    out.cuts.clear();
    s.overlapping.clear();
    for (std::uint32_t i = 0; i < pairs.size(); ++i) {
        if (pairs[i].overlapping && pairs[i].onA.allFinite()) {
            s.overlapping.push_back(i);
        }
    }
    if (s.overlapping.empty()) {
        return;
    }
    const auto count = static_cast<std::uint32_t>(s.overlapping.size());
    s.taken.assign(count, 0);
    s.grid.reset(count, spacing);
    for (std::uint32_t i = count; i-- > 0;) {
        s.grid.insert(i, pairs[s.overlapping[i]].onA);
    }
    for (std::uint32_t seed = 0; seed < count; ++seed) {
        if (s.taken[seed] != 0) {
            continue;
        }
        s.taken[seed] = 1;
        s.queue.assign(1, seed);
        for (std::size_t at = 0; at < s.queue.size(); ++at) {
            const Eigen::Vector3f middle = pairs[s.overlapping[s.queue[at]]].onA;
            s.grid.take(middle, [&](std::uint32_t other) {
                if (s.taken[other] != 0) {
                    return true;
                }
                if ((pairs[s.overlapping[other]].onA - middle).squaredNorm() > spacing * spacing) {
                    return false;
                }
                s.taken[other] = 1;
                s.queue.push_back(other);
                return true;
            });
        }
        SurfaceCut& surfaceCut = out.cuts.emplace_back();
        surfaceCut.begin = static_cast<std::uint32_t>(out.pieces.size());
        surfaceCut.end = surfaceCut.begin + static_cast<std::uint32_t>(s.queue.size());
        for (const std::uint32_t member : s.queue) {
            const TriangleContact& contact = pairs[s.overlapping[member]];
            CutPiece& piece = out.pieces.emplace_back();
            piece.pair = contact.pair;
            piece.middle = contact.onA;
            piece.overlap = std::max(0.0F, -contact.signedDistance);
            if (const auto segment =
                    cut(cornersOf(a.tree, contact.pair.triangleA), cornersOf(b.tree, contact.pair.triangleB, bInA))) {
                piece.segment = *segment;
                piece.hasSegment = true;
            }
            surfaceCut.center += contact.onA.cast<double>();
        }
        surfaceCut.center /= static_cast<double>(s.queue.size());
        surfaceCut.normal = normalOf(a, b, bInA, out.piecesOf(surfaceCut), surfaceCut.center);
    }
}

}  // namespace grapeshot::detail
