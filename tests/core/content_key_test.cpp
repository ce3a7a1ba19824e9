#include <grapeshot/core/content_key.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include <scenes/shapes.hpp>

namespace grapeshot {
namespace {

using scenes::Mesh;

TEST(ContentKey, TellsContentApartAndNothingElse) {
    const Mesh mesh = scenes::torus(1, 0.3F, 12, 8);
    const ContentKey key = contentKey(mesh.view());
    const Mesh copy = mesh;
    EXPECT_EQ(contentKey(copy.view()), key);
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        Mesh changed = mesh;
        float& x = changed.vertices[v].x();
        x = std::nextafter(x, 10.0F);
        EXPECT_NE(contentKey(changed.view()), key) << "vertex " << v;
    }
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        Mesh changed = mesh;
        std::swap(changed.triangles[t][0], changed.triangles[t][1]);
        EXPECT_NE(contentKey(changed.view()), key) << "triangle " << t;
    }
}

TEST(ContentKey, KnowsWhereTheVerticesEnd) {
    // The same bytes in a row, split differently between vertices and triangles.
    const Mesh empty;
    Mesh vertexOnly;
    vertexOnly.vertices.emplace_back(0, 0, 0);
    Mesh triangleOnly;
    triangleOnly.triangles.push_back({0, 0, 0});
    EXPECT_NE(contentKey(vertexOnly.view()), contentKey(triangleOnly.view()));
    EXPECT_NE(contentKey(vertexOnly.view()), contentKey(empty.view()));
}

}  // namespace
}  // namespace grapeshot
