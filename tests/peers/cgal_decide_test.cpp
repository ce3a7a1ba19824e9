// Our exact yes and no against CGAL's, whose predicates are exact for the double coordinates that they are given.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Rigid_triangle_mesh_collision_detection.h>
#include <CGAL/Surface_mesh.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <import/mesh_import.hpp>
#include <support/oracle.hpp>
#include <support/poses.hpp>
#include <support/test_size.hpp>

#include <grapeshot/adb/query.hpp>

namespace grapeshot::test {
namespace {

namespace fs = std::filesystem;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using CgalMesh = CGAL::Surface_mesh<Kernel::Point_3>;

CgalMesh toCgal(const scenes::Mesh& mesh) {
    CgalMesh result;
    for (const Eigen::Vector3f& v : mesh.vertices) {
        result.add_vertex(Kernel::Point_3(v.x(), v.y(), v.z()));
    }
    for (const Triangle& t : mesh.triangles) {
        const auto corner = [&](int c) { return CgalMesh::Vertex_index(t[static_cast<std::size_t>(c)]); };
        if (result.add_face(corner(0), corner(1), corner(2)) == CgalMesh::null_face()) {
            throw std::runtime_error("not manifold");
        }
    }
    return result;
}

CGAL::Aff_transformation_3<Kernel> toCgal(const Pose& pose) {
    const Eigen::Matrix3d r = pose.rotation.cast<double>();
    const Eigen::Vector3d t = pose.translation.cast<double>();
    return {r(0, 0), r(0, 1), r(0, 2), t(0), r(1, 0), r(1, 1), r(1, 2), t(1), r(2, 0), r(2, 1), r(2, 2), t(2)};
}

/// Every pose on which the two contradict each other must be on the border: gap or depth below 1e-6 of the size.
void compareWithCgal(const scenes::Mesh& mesh, const std::string& name, std::size_t count) {
    const Tree tree = build(mesh.view());
    Query query(tree, tree);
    CGAL::Rigid_triangle_mesh_collision_detection<CgalMesh> cgal;
    const CgalMesh cgalMesh = toCgal(mesh);
    cgal.add_mesh(cgalMesh);
    const std::size_t moving = cgal.add_mesh(cgalMesh);
    const double size = (tree.upper - tree.lower).norm();

    constexpr int perDistance = 10;
    const PoseSet set = zachmannPoses(tree, tree, static_cast<int>(count) / perDistance, perDistance, 2003);
    std::size_t colliding = 0;
    for (const Pose& pose : set.poses) {
        cgal.set_transformation(moving, toCgal(pose));
        const bool theirs = !cgal.get_all_intersections(moving).empty();
        const bool ours = query.decide(pose, DecideSettings::exact()).collides;
        colliding += theirs ? 1U : 0U;
        if (ours != theirs) {
            EXPECT_LT(std::abs(bruteForceClearance(mesh.view(), mesh.view(), pose)), 1e-6 * size) << name;
        }
    }
    EXPECT_GT(colliding, set.poses.size() / 10) << name;
    EXPECT_LT(colliding, set.poses.size() * 9 / 10) << name;
}

TEST(Cgal, AgreesOnGeneratedMeshes) {
    const std::size_t poses = sampleSize(300, 3000);
    compareWithCgal(scenes::torusKnot(2, 3, 1.0F, 0.4F, 0.15F, 200, 12), "torus knot", poses);
    compareWithCgal(scenes::bumpySphere(1.0F, 0.3F, 12, 12), "bumpy sphere", poses);
    compareWithCgal(scenes::cup(1.0F, 0.1F, 2.0F, 48, 16), "cup", poses);
    compareWithCgal(scenes::box(Eigen::Vector3f(1, 1, 1), 4), "box", poses);
}

TEST(Cgal, AgreesOnItsOwnMeshes) {
    const fs::path archive = "/usr/share/doc/libcgal-dev/data.tar.gz";
    if (!fs::exists(archive)) {
        GTEST_SKIP() << "libcgal-demo is not installed";
    }
    const fs::path folder = fs::temp_directory_path() / "grapeshot_cgal_meshes";
    fs::create_directories(folder);
    ASSERT_EQ(std::system(("tar xzf " + archive.string() + " -C " + folder.string() + " data/meshes").c_str()), 0);
    for (const char* name : {"elephant.off", "fandisk.off", "anchor.off", "camel.off", "knot1.off"}) {
        compareWithCgal(import::importMesh(folder / "data/meshes" / name), name, sampleSize(200, 4000));
    }
    fs::remove_all(folder);
}

}  // namespace
}  // namespace grapeshot::test
