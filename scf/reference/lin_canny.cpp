#include <grapeshot/scf/reference/lin_canny.hpp>

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <optional>

#include <grapeshot/core/error.hpp>
#include <grapeshot/scf/reference/simplex_distance.hpp>

namespace grapeshot::scf::reference {

namespace {

using Eigen::Vector3d;

/// A body where it is now, in A's frame.
struct Placed {
    const ConvexPolyhedron& body;
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
    Vector3d translation = Vector3d::Zero();

    [[nodiscard]] Vector3d at(std::uint32_t vertex) const { return rotation * body.vertices[vertex] + translation; }
    [[nodiscard]] Simplex simplex(const Feature& feature) const {
        Simplex result;
        result.count = 0;
        for (const std::uint32_t corner : body.cornersOf(feature)) {
            result.corners[std::size_t(result.count++)] = at(corner);
        }
        return result;
    }
    /// From the moved corners, so that it belongs to the linear map that the pose is, rounding included.
    [[nodiscard]] Vector3d normal(std::uint32_t face) const {
        const auto& corners = body.faces[face].corners;
        const Vector3d a = at(corners[0]);
        return (at(corners[1]) - a).cross(at(corners[2]) - a).normalized();
    }
};

/// The feature whose corners have their bits set.
Feature partOf(const ConvexPolyhedron& body, const Feature& feature, unsigned part) {
    const int corners = __builtin_popcount(part);
    const auto all = body.cornersOf(feature);
    if (corners == static_cast<int>(all.size())) {
        return feature;
    }
    if (corners == 1) {
        return {FeatureKind::vertex, all[std::size_t(__builtin_ctz(part))]};
    }
    const std::size_t edge = part == 3 ? 0 : part == 6 ? 1 : 2;
    return {FeatureKind::edge, body.faces[feature.index].edges[edge]};
}

/// What `point` says of the Voronoi region of the feature whose closest point is `own`.
struct RegionTest {
    std::optional<Feature> beyond;  ///< the neighbour across the plane that is violated most
    bool behind = false;            ///< of every face at the feature
};

/// How far out of a region still is in it, as a sine: stepping on would gain less than rounding.
constexpr double slackSine = 1e-10;

/// Faces in one plane have edges and corners between them whose planes alone let pass what lies behind them.
bool isBehind(const Placed& placed, const Feature& feature, const Vector3d& toPoint) {
    const auto behindBoth = [&](std::uint32_t edge) {
        const auto& faces = placed.body.edges[edge].faces;
        return placed.normal(faces[0]).dot(toPoint) < 0 && placed.normal(faces[1]).dot(toPoint) < 0;
    };
    switch (feature.kind) {
        case FeatureKind::vertex:
            return std::ranges::all_of(placed.body.edgesOf(feature.index), behindBoth);
        case FeatureKind::edge:
            return behindBoth(feature.index);
        case FeatureKind::face:
            break;
    }
    return placed.normal(feature.index).dot(toPoint) < 0;
}

RegionTest testRegion(const Placed& placed, const Feature& feature, const Vector3d& own, const Vector3d& point) {
    const ConvexPolyhedron& body = placed.body;
    const Vector3d toPoint = point - own;
    RegionTest result;
    double most = slackSine * toPoint.norm();
    switch (feature.kind) {
        case FeatureKind::vertex:
            for (const std::uint32_t e : body.edgesOf(feature.index)) {
                const auto& ends = body.edges[e].ends;
                const std::uint32_t other = ends[0] == feature.index ? ends[1] : ends[0];
                const double beyond = toPoint.dot((placed.at(other) - own).normalized());
                if (beyond > most) {
                    most = beyond;
                    result.beyond = Feature{FeatureKind::edge, e};
                }
            }
            break;
        case FeatureKind::edge: {
            const ConvexPolyhedron::Edge& edge = body.edges[feature.index];
            const Vector3d from = placed.at(edge.ends[0]);
            const Vector3d along = (placed.at(edge.ends[1]) - from).normalized();
            for (const std::uint32_t f : edge.faces) {
                for (const std::uint32_t corner : body.faces[f].corners) {
                    if (corner == edge.ends[0] || corner == edge.ends[1]) {
                        continue;
                    }
                    const Vector3d into = placed.at(corner) - from;
                    const double beyond = toPoint.dot((into - along * along.dot(into)).normalized());
                    if (beyond > most) {
                        most = beyond;
                        result.beyond = Feature{FeatureKind::face, f};
                    }
                }
            }
            break;
        }
        case FeatureKind::face:
            break;
    }
    result.behind = !result.beyond && isBehind(placed, feature, toPoint);
    return result;
}

/// V-Clip's way out of a stuck face: on to the face that the point is farthest in front of; none: it is inside.
std::optional<Feature> faceInFrontOf(const Placed& placed, const Vector3d& point) {
    double most = 0;
    std::optional<Feature> best;
    for (std::uint32_t f = 0; f < placed.body.faces.size(); ++f) {
        const double inFront = placed.normal(f).dot(point - placed.at(placed.body.faces[f].corners[0]));
        if (inFront > most) {
            most = inFront;
            best = Feature{FeatureKind::face, f};
        }
    }
    return best;
}

void requireExisting(const ConvexPolyhedron& body, const Feature& feature, const char* place) {
    if (feature.index >= body.count(feature.kind)) {
        throw Error(Fault::indexOutOfRange, "feature " + std::to_string(feature.index), place);
    }
}

}  // namespace

LinCanny::LinCanny(const ConvexPolyhedron& a, const ConvexPolyhedron& b, const LinCannySettings& settings)
    : m_a(&a), m_b(&b), m_settings(settings) {
    if (settings.mostSteps < 0) {
        throw Error(Fault::badSetting, "mostSteps is " + std::to_string(settings.mostSteps) + ", not 0 or more",
                    "settings");
    }
    if (settings.mostSteps == 0) {
        m_settings.mostSteps = static_cast<int>(64 + 8 * (a.faces.size() + b.faces.size()));
    }
}

void LinCanny::startAt(const Feature& a, const Feature& b) {
    requireExisting(*m_a, a, "feature of A");
    requireExisting(*m_b, b, "feature of B");
    m_lastA = a;
    m_lastB = b;
}

ClosestFeatures LinCanny::closest(const Pose& bInA) {
    if (!bInA.rotation.allFinite() || !bInA.translation.allFinite()) {
        throw Error(Fault::notFinite, "a NaN or an infinity", "pose");
    }
    if (!isRigid(bInA)) {
        throw Error(Fault::notRigid, "the rotation is not orthonormal and right-handed", "pose");
    }
    const Placed a{*m_a};
    const Placed b{*m_b, bInA.rotation.cast<double>(), bInA.translation.cast<double>()};
    const double touching = 1e-14 * (m_a->size + m_b->size + b.translation.norm());
    ClosestFeatures answer;
    answer.a = m_settings.coherent ? m_lastA : Feature();
    answer.b = m_settings.coherent ? m_lastB : Feature();
    Feature nextA = answer.a;
    Feature nextB = answer.b;
    // Each step to a neighbour brings the bodies' features closer; one that does not is rounding.
    double before = std::numeric_limits<double>::infinity();
    while (answer.steps < m_settings.mostSteps) {
        ++answer.steps;
        const ClosestPoints points = closestPoints(a.simplex(nextA), b.simplex(nextB));
        if (points.distance >= before) {
            answer.outcome = Outcome::closest;
            break;
        }
        before = points.distance;
        answer.distance = points.distance;
        answer.onA = points.onA;
        answer.onB = points.onB;
        answer.a = nextA = partOf(*m_a, nextA, points.partOfA);
        answer.b = nextB = partOf(*m_b, nextB, points.partOfB);
        if (points.distance <= touching) {
            answer.outcome = Outcome::penetrating;
            break;
        }
        const RegionTest ofA = testRegion(a, nextA, points.onA, points.onB);
        if (ofA.beyond) {
            nextA = *ofA.beyond;
            continue;
        }
        const RegionTest ofB = testRegion(b, nextB, points.onB, points.onA);
        if (ofB.beyond) {
            nextB = *ofB.beyond;
            continue;
        }
        if (!ofA.behind && !ofB.behind) {
            answer.outcome = Outcome::closest;
            break;
        }
        ++answer.stuck;
        const std::optional<Feature> way = ofA.behind ? faceInFrontOf(a, points.onB) : faceInFrontOf(b, points.onA);
        if (!way) {
            answer.outcome = Outcome::penetrating;
            break;
        }
        (ofA.behind ? nextA : nextB) = *way;
        before = std::numeric_limits<double>::infinity();
    }
    if (answer.outcome == Outcome::penetrating) {
        answer.distance = 0;
    }
    m_lastA = answer.a;
    m_lastB = answer.b;
    return answer;
}

}  // namespace grapeshot::scf::reference
