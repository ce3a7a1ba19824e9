#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include <grapeshot/adb/query.hpp>
#include <grapeshot/adb/tree.hpp>
#include <grapeshot/core/error.hpp>
#include <support/fault_of.hpp>
#include <support/oracle.hpp>
#include <support/poses.hpp>

#include "meshes.hpp"

namespace grapeshot::test {
namespace {

/// Twisted about y and waved: no triangle keeps its shape.
std::vector<Eigen::Vector3f> deformed(const std::vector<Eigen::Vector3f>& vertices, float amount) {
    std::vector<Eigen::Vector3f> out;
    for (const Eigen::Vector3f& v : vertices) {
        const float angle = amount * v.y();
        out.emplace_back(v.x() * std::cos(angle) - v.z() * std::sin(angle), v.y() + amount * 0.3F * std::sin(3 * v.x()),
                         v.x() * std::sin(angle) + v.z() * std::cos(angle));
    }
    return out;
}

TEST(Refit, LeavesASoundTree) {
    for (const NamedMesh& kind : everyKind()) {
        Tree tree = build(kind.mesh.view());
        for (const float amount : {0.3F, 2.0F, 0.0F}) {
            refit(tree, deformed(kind.mesh.vertices, amount));
            EXPECT_THAT(findings(tree), ::testing::IsEmpty()) << kind.name << " " << amount;
        }
    }
}

TEST(Refit, ToTheSamePlaceIsTheBuild) {
    for (const NamedMesh& kind : everyKind()) {
        const Tree built = build(kind.mesh.view());
        Tree tree = built;
        refit(tree, deformed(kind.mesh.vertices, 1));
        EXPECT_NE(std::memcmp(tree.nodes.data(), built.nodes.data(), built.nodes.size() * sizeof(Node)), 0);
        refit(tree, kind.mesh.vertices);
        EXPECT_EQ(std::memcmp(tree.nodes.data(), built.nodes.data(), built.nodes.size() * sizeof(Node)), 0)
            << kind.name;
        EXPECT_EQ(std::memcmp(tree.distributions.data(), built.distributions.data(),
                              built.distributions.size() * sizeof(NodeDistribution)),
                  0);
        EXPECT_EQ(tree.radius, built.radius);
    }
}

TEST(Refit, QueriesAnswerForTheNewShape) {
    Random random(4);
    int colliding = 0;
    int poses = 0;
    for (const NamedMesh& kind : everyKind()) {
        Tree tree = build(kind.mesh.view());
        const scenes::Mesh moved{deformed(kind.mesh.vertices, 1), kind.mesh.triangles};
        refit(tree, moved.vertices);
        const Tree other = build(kind.mesh.view());
        Query query(tree, other);
        for (int i = 0; i < 10; ++i, ++poses) {
            const Pose pose = randomPose(tree, other, random);
            const Decision decision = query.decide(pose, DecideSettings::exact());
            colliding += decision.collides ? 1 : 0;
            if (decision.collides != bruteForceDecide(moved.view(), kind.mesh.view(), pose)) {
                EXPECT_LE(std::abs(bruteForceClearance(moved.view(), kind.mesh.view(), pose)), 1e-6 * sizeOf(tree))
                    << kind.name;
            }
        }
    }
    EXPECT_GT(colliding, poses / 5);
    EXPECT_LT(colliding, poses * 9 / 10);
}

TEST(Refit, ZeroAreaTrianglesMayBecomeReal) {
    scenes::Mesh mesh = scenes::box({1, 1, 1});
    mesh.vertices.insert(mesh.vertices.end(), {{5, 0, 0}, {5, 0, 0}, {5, 0, 0}});
    const auto last = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.triangles.push_back({last - 3, last - 2, last - 1});
    Tree tree = build(mesh.view());
    mesh.vertices[last - 1] = {5, 3, 0};
    mesh.vertices[last - 2] = {5, 0, 3};
    refit(tree, mesh.vertices);
    EXPECT_THAT(findings(tree), ::testing::IsEmpty());
    const Tree ball = build(scenes::sphere(0.2F, 3).view());
    Query query(tree, ball);
    EXPECT_TRUE(query.decide({Eigen::Matrix3f::Identity(), {5, 1, 1}}, DecideSettings::exact()).collides);
}

TEST(Refit, RefusesAndLeavesTheTreeAlone) {
    const scenes::Mesh mesh = scenes::sphere(1, 3);
    const Tree built = build(mesh.view());
    Tree tree = built;
    const auto faultOfRefit = [&tree](const std::vector<Eigen::Vector3f>& vertices) {
        return faultOf([&] { refit(tree, vertices); });
    };
    std::vector<Eigen::Vector3f> vertices = mesh.vertices;
    vertices.pop_back();
    EXPECT_EQ(faultOfRefit(vertices), Fault::topologyChanged);
    vertices = mesh.vertices;
    vertices[7].z() = std::numeric_limits<float>::infinity();
    EXPECT_EQ(faultOfRefit(vertices), Fault::notFinite);
    vertices[7].z() = -3e15F;
    EXPECT_EQ(faultOfRefit(vertices), Fault::tooLarge);
    EXPECT_EQ(std::memcmp(tree.nodes.data(), built.nodes.data(), built.nodes.size() * sizeof(Node)), 0);
    EXPECT_EQ(tree.vertices, built.vertices);
}

}  // namespace
}  // namespace grapeshot::test
