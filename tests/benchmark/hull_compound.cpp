// This work is based on:
// Khaled Mamou, Faouzi Ghorbel. A simple and efficient approach for 3D mesh approximate convex decomposition. ICIP 2009
// (HACD, as Bullet's extras have it)
#include "hull_compound.hpp"

#include <hacdHACD.h>

#include <deque>
#include <limits>
#include <stdexcept>
#include <vector>

#include "decimation.hpp"

namespace grapeshot::bench {

using scenes::Mesh;

namespace {

using Hull = std::vector<Eigen::Vector3f>;

struct Decomposition {
    Mesh mesh;
    HullSettings settings;
    std::vector<Hull> hulls;
};

std::vector<Hull> decomposed(const Mesh& fine, const HullSettings& settings) {
    const Mesh mesh = fine.triangles.size() > settings.triangles ? decimated(fine.view(), settings.triangles) : fine;
    std::vector<HACD::Vec3<HACD::Real>> points;
    for (const Eigen::Vector3f& v : mesh.vertices) {
        points.emplace_back(v.x(), v.y(), v.z());
    }
    std::vector<HACD::Vec3<long>> triangles;
    for (const Triangle& t : mesh.triangles) {
        triangles.emplace_back(t[0], t[1], t[2]);
    }
    HACD::HACD hacd;
    hacd.SetPoints(points.data());
    hacd.SetNPoints(points.size());
    hacd.SetTriangles(triangles.data());
    hacd.SetNTriangles(triangles.size());
    hacd.SetNClusters(static_cast<std::size_t>(settings.hulls));
    // Only the number of hulls ends it.
    hacd.SetConcavity(std::numeric_limits<double>::max());
    hacd.SetNVerticesPerCH(64);
    hacd.SetVolumeWeight(0);
    hacd.SetCompacityWeight(0.0001);
    hacd.SetAddExtraDistPoints(true);
    hacd.SetAddFacesPoints(true);
    if (!hacd.Compute()) {
        throw std::runtime_error("HACD: no decomposition");
    }
    std::vector<Hull> hulls;
    for (std::size_t h = 0; h < hacd.GetNClusters(); ++h) {
        std::vector<HACD::Vec3<HACD::Real>> corners(hacd.GetNPointsCH(h));
        std::vector<HACD::Vec3<long>> faces(hacd.GetNTrianglesCH(h));
        hacd.GetCH(h, corners.data(), faces.data());
        Hull& hull = hulls.emplace_back();
        for (const HACD::Vec3<HACD::Real>& corner : corners) {
            hull.push_back(Eigen::Vector3d(corner.X(), corner.Y(), corner.Z()).cast<float>());
        }
    }
    return hulls;
}

const std::vector<Hull>& hullsOf(const Mesh& mesh, const HullSettings& settings) {
    constexpr std::size_t remembered = 16;
    static std::deque<Decomposition> known;
    for (const Decomposition& entry : known) {
        if (entry.settings == settings && entry.mesh.vertices == mesh.vertices &&
            entry.mesh.triangles == mesh.triangles) {
            return entry.hulls;
        }
    }
    if (known.size() == remembered) {
        known.pop_front();
    }
    known.push_back({mesh, settings, decomposed(mesh, settings)});
    return known.back().hulls;
}

struct Compound {
    std::vector<std::unique_ptr<btConvexHullShape>> hulls;
    btCompoundShape shape;
};

}  // namespace

std::shared_ptr<btCollisionShape> hullCompound(const Mesh& mesh, const HullSettings& settings, double margin) {
    const auto compound = std::make_shared<Compound>();
    for (const Hull& hull : hullsOf(mesh, settings)) {
        btConvexHullShape& child = *compound->hulls.emplace_back(std::make_unique<btConvexHullShape>());
        for (const Eigen::Vector3f& corner : hull) {
            child.addPoint({corner.x(), corner.y(), corner.z()}, false);
        }
        child.recalcLocalAabb();
        child.setMargin(static_cast<btScalar>(margin));
        compound->shape.addChildShape(btTransform::getIdentity(), &child);
    }
    return {compound, &compound->shape};
}

}  // namespace grapeshot::bench
