#include "triangle_pairs.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace grapeshot::test {
namespace {

using Eigen::Vector3d;

Vector3d inCube(Random& random, double half = 1) {
    return {random.uniform(-half, half), random.uniform(-half, half), random.uniform(-half, half)};
}

double powerOfTen(Random& random, double low, double high) {
    return std::pow(10.0, random.uniform(low, high));
}

using TriangleD = std::array<Vector3d, 3>;

TriangleF rounded(const TriangleD& triangle) {
    return {triangle[0].cast<float>(), triangle[1].cast<float>(), triangle[2].cast<float>()};
}

void shift(TriangleD& triangle, const Vector3d& by) {
    for (Vector3d& corner : triangle) {
        corner += by;
    }
}

Vector3d onEdge(const TriangleD& triangle, double t) {
    return triangle[0] + t * (triangle[1] - triangle[0]);
}

/// Edges 0 cross near the origin at a small angle and height; the triangles stand on either side.
void crossAlmostParallel(TriangleD& a, TriangleD& b, Random& random) {
    const double angle = powerOfTen(random, -6, 0);
    const double height = powerOfTen(random, -6, -1) * (random.unit() < 0.5 ? 1 : -1);
    const Vector3d e = inCube(random).normalized();
    const Vector3d side = e.cross(inCube(random)).normalized();
    const Vector3d up = e.cross(side);
    const Vector3d g = (e + angle * side).normalized();
    const auto third = [&](double direction) -> Vector3d {
        return direction * random.uniform(0.2, 1) * up + random.uniform(-1, 1) * side + random.uniform(-1, 1) * e;
    };
    a = {-random.uniform(0.1, 1) * e, random.uniform(0.1, 1) * e, third(-1)};
    b = {-random.uniform(0.1, 1) * g, random.uniform(0.1, 1) * g, third(1)};
    shift(b, height * up);
}

void flatten(TriangleD& triangle, Random& random) {
    const double kind = random.unit();
    if (kind < 0.3) {
        triangle[2] = triangle[0];
    } else if (kind < 0.6) {
        triangle[2] = 0.5 * (triangle[0] + triangle[1]);
    } else if (kind < 0.8) {
        triangle[1] = triangle[2] = triangle[0];
    }
}

}  // namespace

const char* nameOf(PairKind kind) {
    static constexpr std::array names = {"anywhere", "unlikeSize",     "edgeOnEdge", "cornerOnFace", "almostParallel",
                                         "sliver",   "almostCoplanar", "coplanar",   "lattice",      "degenerate"};
    return names[static_cast<std::size_t>(kind)];
}

TrianglePairF makePair(PairKind kind, Random& random) {
    TriangleD a = {inCube(random), inCube(random), inCube(random)};
    TriangleD b = {inCube(random), inCube(random), inCube(random)};
    switch (kind) {
        case PairKind::anywhere:
            break;
        case PairKind::unlikeSize: {
            const double factor = powerOfTen(random, -5, -1);
            const Vector3d place =
                a[0] + random.uniform(0, 0.6) * (a[1] - a[0]) + random.uniform(0, 0.6) * (a[2] - a[0]);
            for (Vector3d& corner : b) {
                corner *= factor;
            }
            shift(b, place);
            break;
        }
        case PairKind::edgeOnEdge:
            shift(b, onEdge(a, random.unit()) - onEdge(b, random.unit()) + powerOfTen(random, -7, -2) * inCube(random));
            break;
        case PairKind::cornerOnFace:
            shift(b, a[0] + random.uniform(0, 0.5) * (a[1] - a[0]) + random.uniform(0, 0.5) * (a[2] - a[0]) - b[0] +
                         powerOfTen(random, -7, -2) * inCube(random));
            break;
        case PairKind::almostParallel:
            crossAlmostParallel(a, b, random);
            break;
        case PairKind::sliver:
            a[2] = onEdge(a, random.uniform(-0.2, 1.2)) + inCube(random, powerOfTen(random, -5, -1));
            b[2] = onEdge(b, random.uniform(-0.2, 1.2)) + inCube(random, powerOfTen(random, -5, -1));
            shift(b, onEdge(a, random.unit()) - onEdge(b, random.unit()));
            break;
        case PairKind::almostCoplanar:
        case PairKind::coplanar: {
            const double height = kind == PairKind::coplanar ? 0 : powerOfTen(random, -7, -1);
            const Eigen::Matrix3d turn = kind == PairKind::coplanar ? Eigen::Matrix3d(Eigen::Matrix3d::Identity())
                                                                    : Eigen::Matrix3d(random.rotation().cast<double>());
            const double apart = random.uniform(0, 1);
            for (int i = 0; i < 3; ++i) {
                a[i].z() *= height;
                b[i].z() *= height;
                b[i].x() += apart;
                a[i] = turn * a[i];
                b[i] = turn * b[i];
            }
            break;
        }
        case PairKind::lattice:
            for (int i = 0; i < 3; ++i) {
                a[i] = (2 * a[i]).array().round();
                b[i] = (2 * b[i]).array().round();
            }
            break;
        case PairKind::degenerate:
            flatten(a, random);
            flatten(b, random);
            if (random.unit() < 0.5) {
                shift(b, onEdge(a, random.unit()) - onEdge(b, random.unit()) +
                             powerOfTen(random, -5, -1) * inCube(random));
            }
            break;
    }
    return {rounded(a), rounded(b)};
}

PairBatch toBatch(std::span<const TrianglePairF> pairs) {
    PairBatch batch;
    for (int lane = 0; lane < batchWidth; ++lane) {
        const TrianglePairF& pair = pairs[static_cast<std::size_t>(lane) % pairs.size()];
        batch.pairs[lane] = pair;
        for (int corner = 0; corner < 3; ++corner) {
            for (int axis = 0; axis < 3; ++axis) {
                batch.a.corner[corner][axis][lane] = pair.a[corner][axis];
                batch.b.corner[corner][axis][lane] = pair.b[corner][axis];
            }
        }
    }
    return batch;
}

PairBatch makeBatch(PairKind kind, Random& random) {
    std::vector<TrianglePairF> pairs;
    for (int lane = 0; lane < batchWidth; ++lane) {
        pairs.push_back(makePair(kind, random));
    }
    return toBatch(pairs);
}

Corners toCorners(const TriangleF& triangle) {
    return {triangle[0].cast<double>(), triangle[1].cast<double>(), triangle[2].cast<double>()};
}

double extentOf(const TrianglePairF& pair) {
    double extent = 0;
    for (int i = 0; i < 3; ++i) {
        extent = std::max<double>(extent, (pair.a[i].cast<double>() - pair.a[0].cast<double>()).norm());
        extent = std::max<double>(extent, (pair.b[i].cast<double>() - pair.a[0].cast<double>()).norm());
    }
    return extent;
}

}  // namespace grapeshot::test
