#include <grapeshot/scf/detail/moved_since.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace grapeshot::detail {
namespace {

constexpr float unknown = std::numeric_limits<float>::infinity();
/// Of positions and of distances in single precision, per metre of both surfaces' size.
constexpr double rounding = 3e-6;

struct Frame {
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
    Eigen::Vector3d translation = Eigen::Vector3d::Zero();
    double skew = 0;  ///< of the rotation: `isRigid` lets some pass
};

Frame frameOf(const std::optional<Pose>& pose) {
    Frame frame;
    if (pose) {
        frame.rotation = pose->rotation.cast<double>();
        frame.translation = pose->translation.cast<double>();
        frame.skew = (frame.rotation.transpose() * frame.rotation - Eigen::Matrix3d::Identity()).norm();
    }
    return frame;
}

bool isSame(const std::optional<Pose>& one, const std::optional<Pose>& other) {
    return one.has_value() == other.has_value() &&
           (!one || (one->rotation == other->rotation && one->translation == other->translation));
}

Frame seenFrom(const Frame& frame, const Frame& inIt) {
    return {frame.rotation.transpose() * inIt.rotation,
            frame.rotation.transpose() * (inIt.translation - frame.translation), 0};
}

/// Of a point at most `extent` from the frame's origin. The difference of two rotations stretches by its Frobenius norm
/// / sqrt(2) at most.
double wayOf(const Frame& from, const Frame& to, double extent) {
    return (to.translation - from.translation).norm() + (to.rotation - from.rotation).norm() * 0.70711 * extent;
}

float roundedUp(double value) {
    return std::nextafter(static_cast<float>(value), unknown);
}

}  // namespace

Deformation deformationSince(const SurfaceBefore& before, const SurfaceState& now, const Surface& surface,
                             float restExtent) {
    using Source = Displacement::Source;
    if (now.displacement.source == Source::given) {
        return {before.isKnown ? now.displacement.bound : unknown, restExtent};
    }
    const std::span<const Eigen::Vector3f> positions = now.positions.empty() ? surface.rest : now.positions;
    if (now.positions.empty() && (before.atRest || now.displacement.source != Source::measured)) {
        return {before.isKnown && before.atRest ? 0 : unknown, restExtent};
    }
    if (now.displacement.source != Source::measured) {
        return {unknown, restExtent};
    }
    const std::span<const Eigen::Vector3f> last = before.atRest ? surface.rest : before.positions;
    float square = 0;
    float extent = 0;
    float finite = 0;  // stays 0, or becomes NaN
    for (std::size_t i = 0; i < positions.size(); ++i) {
        const Eigen::Vector3f& p = positions[i];
        finite += (p[0] - p[0]) + (p[1] - p[1]) + (p[2] - p[2]);
        extent = std::max(extent, p.squaredNorm());
        if (!last.empty()) {
            square = std::max(square, (p - last[i]).squaredNorm());
        }
    }
    if (!(finite == 0)) {
        return {std::numeric_limits<float>::quiet_NaN(), 0};
    }
    const bool isKnown = before.isKnown && !last.empty();
    return {isKnown ? std::sqrt(square) * (1 + 1e-6F) : unknown, std::sqrt(extent) * (1 + 1e-6F)};
}

void remember(const SurfaceState& now, const Deformation& deformation, SurfaceBefore& out) {
    out.isKnown = true;
    out.atRest = now.positions.empty();
    out.pose = now.pose;
    out.extent = deformation.extent;
    if (now.displacement.source == Displacement::Source::measured) {
        out.positions.assign(now.positions.begin(), now.positions.end());
    } else {
        out.positions.clear();
    }
}

float nearerThanBefore(const SurfaceBefore& beforeA, const SurfaceState& a, const Deformation& ofA,
                       const SurfaceBefore& beforeB, const SurfaceState& b, const Deformation& ofB) {
    if (!(ofA.most < unknown) || !(ofB.most < unknown)) {
        return unknown;
    }
    const auto isGiven = [](const SurfaceState& state) {
        return state.displacement.source == Displacement::Source::given;
    };
    const double shape = static_cast<double>(ofA.most) + static_cast<double>(ofB.most);
    const bool samePoses = (isGiven(a) || isSame(beforeA.pose, a.pose)) && (isGiven(b) || isSame(beforeB.pose, b.pose));
    if (shape == 0 && samePoses) {
        return 0;
    }
    const Frame fromA = frameOf(beforeA.pose);
    const Frame fromB = frameOf(beforeB.pose);
    const Frame toA = frameOf(a.pose);
    const Frame toB = frameOf(b.pose);
    const auto extentA = static_cast<double>(std::max(beforeA.extent, ofA.extent));
    const auto extentB = static_cast<double>(std::max(beforeB.extent, ofB.extent));
    double way = 0;
    if (isGiven(a) || isGiven(b)) {
        way = (isGiven(a) ? 0 : wayOf(fromA, toA, extentA)) + (isGiven(b) ? 0 : wayOf(fromB, toB, extentB));
    } else if (!samePoses) {
        way = std::min(wayOf(seenFrom(fromA, fromB), seenFrom(toA, toB), extentB),
                       wayOf(seenFrom(fromB, fromA), seenFrom(toB, toA), extentA));
    }
    const double size = extentA + extentB + toA.translation.norm() + toB.translation.norm() + fromA.translation.norm() +
                        fromB.translation.norm();
    const double skew = fromA.skew + fromB.skew + toA.skew + toB.skew;
    return roundedUp(shape + way + (rounding + (samePoses ? 0 : 3 * skew)) * size);
}

float nearerThanBefore(const SurfaceBefore& before, const Deformation& of) {
    if (!(of.most < unknown)) {
        return unknown;
    }
    if (of.most == 0) {
        return 0;
    }
    return roundedUp(2 * static_cast<double>(of.most) +
                     rounding * 2 * static_cast<double>(std::max(before.extent, of.extent)));
}

}  // namespace grapeshot::detail
