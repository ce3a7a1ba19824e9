#include <support/oracle.hpp>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace grapeshot::test {

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Vector3l = Eigen::Matrix<long double, 3, 1>;

/// Point to segment, by projection.
double pointSegment(const Vector3d& p, const Vector3d& a, const Vector3d& b) {
    const Vector3d ab = b - a;
    const double square = ab.squaredNorm();
    const double t = square > 0 ? std::clamp((p - a).dot(ab) / square, 0.0, 1.0) : 0.0;
    return (p - (a + t * ab)).norm();
}

/// The smaller of the four end-point distances and, where the common perpendicular meets both segments, its length,
/// from an orthonormal frame of the two directions.
double segmentSegment(const Vector3d& a0, const Vector3d& a1, const Vector3d& b0, const Vector3d& b1) {
    double best = std::min(
        {pointSegment(a0, b0, b1), pointSegment(a1, b0, b1), pointSegment(b0, a0, a1), pointSegment(b1, a0, a1)});
    const Vector3d u = a1 - a0;
    const Vector3d v = b1 - b0;
    const Vector3d n = u.cross(v);
    if (n.norm() > 1e-12 * u.norm() * v.norm()) {
        // Drop the component along n: two lines in a plane, one crossing.
        const Vector3d x = u.normalized();
        const Vector3d y = n.cross(u).normalized();
        const Vector3d r = b0 - a0;
        const double vy = v.dot(y);
        const double t = -r.dot(y) / vy;
        const double s = (r + t * v).dot(x) / u.norm();
        if (s >= 0 && s <= 1 && t >= 0 && t <= 1) {
            best = std::min(best, std::abs(r.dot(n)) / n.norm());
        }
    }
    return best;
}

/// Signed volume of a tetrahedron, times six.
long double orientation(const Vector3l& a, const Vector3l& b, const Vector3l& c, const Vector3l& d) {
    return (b - a).cross(c - a).dot(d - a);
}

int sign(long double x) {
    return x > 0 ? 1 : (x < 0 ? -1 : 0);
}

using CornersL = std::array<Vector3l, 3>;

CornersL toLong(const Corners& corners, const Vector3d& origin) {
    CornersL result;
    for (int i = 0; i < 3; ++i) {
        result[i] = corners[i].cast<long double>() - origin.cast<long double>();
    }
    return result;
}

/// Does the closed segment pq pass through the closed triangle, the ends on different sides of its plane?
bool pierces(const Vector3l& p, const Vector3l& q, const CornersL& triangle) {
    const int sideP = sign(orientation(triangle[0], triangle[1], triangle[2], p));
    const int sideQ = sign(orientation(triangle[0], triangle[1], triangle[2], q));
    if (sideP * sideQ > 0 || (sideP == 0 && sideQ == 0)) {
        return false;
    }
    const int turn0 = sign(orientation(p, q, triangle[0], triangle[1]));
    const int turn1 = sign(orientation(p, q, triangle[1], triangle[2]));
    const int turn2 = sign(orientation(p, q, triangle[2], triangle[0]));
    return (turn0 >= 0 && turn1 >= 0 && turn2 >= 0) || (turn0 <= 0 && turn1 <= 0 && turn2 <= 0);
}

using Vector2l = Eigen::Matrix<long double, 2, 1>;

long double turn(const Vector2l& a, const Vector2l& b, const Vector2l& c) {
    return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

bool onSegment(const Vector2l& a, const Vector2l& b, const Vector2l& p) {
    return turn(a, b, p) == 0 && (p - a).dot(p - b) <= 0;
}

bool segmentsCross(const Vector2l& a, const Vector2l& b, const Vector2l& c, const Vector2l& d) {
    if (sign(turn(a, b, c)) * sign(turn(a, b, d)) < 0 && sign(turn(c, d, a)) * sign(turn(c, d, b)) < 0) {
        return true;
    }
    return onSegment(a, b, c) || onSegment(a, b, d) || onSegment(c, d, a) || onSegment(c, d, b);
}

bool holds(const std::array<Vector2l, 3>& t, const Vector2l& p) {
    const int s0 = sign(turn(t[0], t[1], p));
    const int s1 = sign(turn(t[1], t[2], p));
    const int s2 = sign(turn(t[2], t[0], p));
    const bool proper = turn(t[0], t[1], t[2]) != 0;
    return proper && ((s0 >= 0 && s1 >= 0 && s2 >= 0) || (s0 <= 0 && s1 <= 0 && s2 <= 0));
}

/// Coplanar pair, dropped to the two axes in which the plane is seen best.
bool coplanarOverlap(const CornersL& a, const CornersL& b, const Vector3l& normal) {
    int drop = 0;
    normal.cwiseAbs().maxCoeff(&drop);
    const int x = (drop + 1) % 3;
    const int y = (drop + 2) % 3;
    std::array<Vector2l, 3> flatA;
    std::array<Vector2l, 3> flatB;
    for (int i = 0; i < 3; ++i) {
        flatA[i] = Vector2l(a[i][x], a[i][y]);
        flatB[i] = Vector2l(b[i][x], b[i][y]);
    }
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            if (segmentsCross(flatA[i], flatA[(i + 1) % 3], flatB[j], flatB[(j + 1) % 3])) {
                return true;
            }
        }
    }
    return holds(flatA, flatB[0]) || holds(flatB, flatA[0]);
}

/// Smallest translation along the given direction that parts the two, negative if they are apart along it.
double overlapAlong(const Corners& a, const Corners& b, const Vector3d& direction) {
    double lowA = std::numeric_limits<double>::infinity();
    double lowB = lowA;
    double highA = -lowA;
    double highB = -lowA;
    for (int i = 0; i < 3; ++i) {
        // Relative to a corner, so that far-away pairs keep their digits.
        const double onA = direction.dot(a[i] - a[0]);
        const double onB = direction.dot(b[i] - a[0]);
        lowA = std::min(lowA, onA);
        highA = std::max(highA, onA);
        lowB = std::min(lowB, onB);
        highB = std::max(highB, onB);
    }
    return std::min(highA - lowB, highB - lowA);
}

double penetration(const Corners& a, const Corners& b) {
    double least = std::numeric_limits<double>::infinity();
    const auto along = [&](const Vector3d& axis, double size) {
        if (axis.norm() > 1e-9 * size) {
            least = std::min(least, std::max(0.0, overlapAlong(a, b, axis.normalized())));
        }
    };
    const auto edge = [](const Corners& t, int i) -> Vector3d { return t[(i + 1) % 3] - t[i]; };
    along(edge(a, 0).cross(edge(a, 1)), edge(a, 0).norm() * edge(a, 1).norm());
    along(edge(b, 0).cross(edge(b, 1)), edge(b, 0).norm() * edge(b, 1).norm());
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            along(edge(a, i).cross(edge(b, j)), edge(a, i).norm() * edge(b, j).norm());
        }
    }
    return std::isfinite(least) ? least : 0.0;
}

/// Axis-aligned boxes of two triangles farther apart than a distance?
bool boxesApart(const Corners& a, const Corners& b, double distance) {
    for (int axis = 0; axis < 3; ++axis) {
        const auto [lowA, highA] = std::minmax({a[0][axis], a[1][axis], a[2][axis]});
        const auto [lowB, highB] = std::minmax({b[0][axis], b[1][axis], b[2][axis]});
        if (lowA > highB + distance || lowB > highA + distance) {
            return true;
        }
    }
    return false;
}

std::vector<Corners> allCorners(MeshView mesh, const Pose& pose = {}) {
    std::vector<Corners> result;
    result.reserve(mesh.triangles.size());
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        result.push_back(cornersOf(mesh, t, pose));
    }
    return result;
}

}  // namespace

double triangleDistance(const Corners& a, const Corners& b) {
    if (trianglesOverlap(a, b)) {
        return 0;
    }
    double best = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            best = std::min(best, segmentSegment(a[i], a[(i + 1) % 3], b[j], b[(j + 1) % 3]));
        }
    }
    const auto cornersOverFace = [&](const Corners& points, const Corners& face) {
        const Vector3d normal = (face[1] - face[0]).cross(face[2] - face[0]);
        if (normal.norm() <= 1e-12 * (face[1] - face[0]).norm() * (face[2] - face[0]).norm()) {
            return;
        }
        const Vector3d n = normal.normalized();
        for (const Vector3d& p : points) {
            bool inside = true;
            for (int j = 0; j < 3; ++j) {
                inside = inside && n.cross(face[(j + 1) % 3] - face[j]).dot(p - face[j]) >= 0;
            }
            if (inside) {
                best = std::min(best, std::abs(n.dot(p - face[0])));
            }
        }
    };
    cornersOverFace(a, b);
    cornersOverFace(b, a);
    return best;
}

bool trianglesOverlap(const Corners& aIn, const Corners& bIn) {
    const CornersL a = toLong(aIn, aIn[0]);
    const CornersL b = toLong(bIn, aIn[0]);
    for (int i = 0; i < 3; ++i) {
        if (pierces(a[i], a[(i + 1) % 3], b) || pierces(b[i], b[(i + 1) % 3], a)) {
            return true;
        }
    }
    const Vector3l normalA = (a[1] - a[0]).cross(a[2] - a[0]);
    const Vector3l normalB = (b[1] - b[0]).cross(b[2] - b[0]);
    const Vector3l& normal = normalA.norm() >= normalB.norm() ? normalA : normalB;
    const CornersL& plane = normalA.norm() >= normalB.norm() ? a : b;
    const CornersL& other = normalA.norm() >= normalB.norm() ? b : a;
    if (normal.norm() == 0) {
        return false;  // two segments: never exactly, but for coincidences that no random test hits
    }
    for (const Vector3l& corner : other) {
        if (orientation(plane[0], plane[1], plane[2], corner) != 0) {
            return false;
        }
    }
    return coplanarOverlap(a, b, normal);
}

double triangleSeparation(const Corners& a, const Corners& b) {
    return trianglesOverlap(a, b) ? penetration(a, b) : triangleDistance(a, b);
}

Corners cornersOf(MeshView mesh, std::uint32_t t, const Pose& pose) {
    const Eigen::Matrix3d rotation = pose.rotation.cast<double>();
    const Vector3d translation = pose.translation.cast<double>();
    Corners corners;
    for (int i = 0; i < 3; ++i) {
        corners[i] = rotation * mesh.vertices[mesh.triangles[t][i]].cast<double>() + translation;
    }
    return corners;
}

bool bruteForceDecide(MeshView a, MeshView b, const Pose& bInA) {
    const std::vector<Corners> trianglesA = allCorners(a);
    const std::vector<Corners> trianglesB = allCorners(b, bInA);
    for (const Corners& first : trianglesA) {
        for (const Corners& second : trianglesB) {
            if (!boxesApart(first, second, 0) && trianglesOverlap(first, second)) {
                return true;
            }
        }
    }
    return false;
}

std::vector<TrianglePair> bruteForcePairs(MeshView a, MeshView b, const Pose& bInA, double maxDistance) {
    const std::vector<Corners> trianglesA = allCorners(a);
    const std::vector<Corners> trianglesB = allCorners(b, bInA);
    std::vector<TrianglePair> pairs;
    for (std::uint32_t i = 0; i < trianglesA.size(); ++i) {
        for (std::uint32_t j = 0; j < trianglesB.size(); ++j) {
            if (!boxesApart(trianglesA[i], trianglesB[j], maxDistance) &&
                triangleDistance(trianglesA[i], trianglesB[j]) <= maxDistance) {
                pairs.push_back({i, j});
            }
        }
    }
    return pairs;
}

double bruteForceClearance(MeshView a, MeshView b, const Pose& bInA) {
    const std::vector<Corners> trianglesA = allCorners(a);
    const std::vector<Corners> trianglesB = allCorners(b, bInA);
    double nearest = std::numeric_limits<double>::infinity();
    double deepest = -1;
    for (const Corners& first : trianglesA) {
        for (const Corners& second : trianglesB) {
            if (boxesApart(first, second, nearest)) {
                continue;
            }
            if (trianglesOverlap(first, second)) {
                deepest = std::max(deepest, penetration(first, second));
                nearest = 0;
            } else if (deepest < 0) {
                nearest = std::min(nearest, triangleDistance(first, second));
            }
        }
    }
    return deepest >= 0 ? -deepest : nearest;
}

}  // namespace grapeshot::test
