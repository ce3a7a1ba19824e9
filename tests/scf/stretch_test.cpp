// The measured stretch of edges, against its definition.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include <grapeshot/scf/stretch.hpp>

#include <adb/meshes.hpp>
#include <support/poses.hpp>

namespace grapeshot::test {
namespace {

TEST(Stretch, IsTheLargestOfAllEdges) {
    Random random(5);
    for (const NamedMesh& mesh : everyKind()) {
        SCOPED_TRACE(mesh.name);
        const Surface surface = makeSurface(mesh.mesh.view());
        EXPECT_EQ(measureStretch(surface, surface.rest), 1);
        std::vector<Eigen::Vector3f> moved = surface.rest;
        for (Eigen::Vector3f& vertex : moved) {
            vertex += 0.01F * random.direction();
        }
        double most = 0;
        for (const Triangle& t : surface.triangles) {
            for (std::size_t i = 0; i < 3; ++i) {
                const std::uint32_t v = t[i];
                const std::uint32_t w = t[(i + 1) % 3];
                const double rest = (surface.rest[v] - surface.rest[w]).cast<double>().norm();
                if (rest > 0) {
                    most = std::max(most, (moved[v] - moved[w]).cast<double>().norm() / rest);
                }
            }
        }
        EXPECT_NEAR(measureStretch(surface, moved), most, 1e-5 * most);
    }
}

TEST(Stretch, OfAScaledBodyIsTheScale) {
    const scenes::Mesh mesh = scenes::sphere(1, 6);
    const Surface surface = makeSurface(mesh.view());
    EXPECT_NEAR(measureStretch(surface, scenes::scaled(mesh, 1.7F).vertices), 1.7F, 1e-5F);
    EXPECT_NEAR(measureStretch(surface, scenes::scaled(mesh, 0.3F).vertices), 0.3F, 1e-5F);
}

TEST(Stretch, KnowsNaNAndEdgesWithoutLength) {
    const std::vector<Eigen::Vector3f> rest{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 1, 0}};
    const std::vector<Triangle> triangles{{0, 1, 2}, {0, 2, 3}};
    const Surface surface = makeSurface({rest, triangles});
    EXPECT_EQ(measureStretch(surface, rest), 1);
    std::vector<Eigen::Vector3f> moved = rest;
    moved[3] = {0, 1, 0.1F};
    EXPECT_EQ(measureStretch(surface, moved), std::numeric_limits<float>::infinity());
    moved[3][1] = std::numeric_limits<float>::quiet_NaN();
    EXPECT_TRUE(std::isnan(measureStretch(surface, moved)));
    moved[3][1] = std::numeric_limits<float>::infinity();
    EXPECT_TRUE(std::isnan(measureStretch(surface, moved)));
}

}  // namespace
}  // namespace grapeshot::test
