#include "clearance.hpp"

#include <algorithm>
#include <vector>

#include <support/oracle.hpp>

namespace grapeshot::bench {

namespace {

struct Entry {
    test::Corners corners;
    Eigen::Vector3d lower, upper;
};

std::vector<Entry> entries(MeshView mesh, const Pose& pose, double inflate) {
    std::vector<Entry> result;
    result.reserve(mesh.triangles.size());
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        const test::Corners c = test::cornersOf(mesh, t, pose);
        result.push_back({c, c[0].cwiseMin(c[1]).cwiseMin(c[2]).array() - inflate,
                          c[0].cwiseMax(c[1]).cwiseMax(c[2]).array() + inflate});
    }
    std::ranges::sort(result, {}, [](const Entry& e) { return e.lower.x(); });
    return result;
}

/// Calls visit(a, b) for all pairs whose boxes meet: a sweep along x.
template <class Visit>
void sweep(const std::vector<Entry>& as, const std::vector<Entry>& bs, const Visit& visit) {
    double widest = 0;
    for (const Entry& b : bs) {
        widest = std::max(widest, b.upper.x() - b.lower.x());
    }
    for (const Entry& a : as) {
        auto b = std::ranges::lower_bound(bs, a.lower.x() - widest, {}, [](const Entry& e) { return e.lower.x(); });
        for (; b != bs.end() && b->lower.x() <= a.upper.x(); ++b) {
            if ((a.lower.array() <= b->upper.array()).all() && (b->lower.array() <= a.upper.array()).all()) {
                visit(a, *b);
            }
        }
    }
}

}  // namespace

double clearance(MeshView a, MeshView b, const Pose& bInA, double reach) {
    double gap = reach;
    double depth = 0;
    bool overlapping = false;
    sweep(entries(a, {}, reach), entries(b, bInA, 0), [&](const Entry& x, const Entry& y) {
        if (test::trianglesOverlap(x.corners, y.corners)) {
            overlapping = true;
            depth = std::max(depth, std::abs(test::triangleSeparation(x.corners, y.corners)));
        } else {
            gap = std::min(gap, test::triangleDistance(x.corners, y.corners));
        }
    });
    return overlapping ? -depth : gap;
}

}  // namespace grapeshot::bench
