// What vertices face, and what meets on its way, against all vertices and triangles.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <vector>

#include <grapeshot/core/detail/closest_on_triangle.hpp>
#include <grapeshot/scf/facing.hpp>
#include <grapeshot/scf/stretch.hpp>

#include <support/oracle.hpp>

namespace grapeshot::test {
namespace {

using FacingVertices = std::vector<Eigen::Vector3f>;

/// A wavy sheet of cells x cells squares in the xz plane.
struct FacingSheet {
    FacingSheet(int cells, float height) {
        for (int i = 0; i <= cells; ++i) {
            for (int k = 0; k <= cells; ++k) {
                const float x = 2.0F * static_cast<float>(i) / static_cast<float>(cells) - 1;
                const float z = 2.0F * static_cast<float>(k) / static_cast<float>(cells) - 1;
                vertices.emplace_back(x, height + 0.05F * std::sin(7 * x + 3 * z), z);
            }
        }
        const auto at = [cells](int i, int k) { return static_cast<std::uint32_t>(i * (cells + 1) + k); };
        for (int i = 0; i < cells; ++i) {
            for (int k = 0; k < cells; ++k) {
                triangles.push_back({at(i, k), at(i, k + 1), at(i + 1, k + 1)});
                triangles.push_back({at(i, k), at(i + 1, k + 1), at(i + 1, k)});
            }
        }
    }
    FacingVertices movedBy(const Eigen::Vector3f& by, float bend) const {
        FacingVertices result = vertices;
        for (Eigen::Vector3f& v : result) {
            v += by + Eigen::Vector3f(0, bend * v.x() * v.x(), 0);
        }
        return result;
    }
    MeshView view() const { return {vertices, triangles}; }

    FacingVertices vertices;
    std::vector<Triangle> triangles;
};

double facingDistance(const Eigen::Vector3f& point, const FacingVertices& vertices, const Triangle& t) {
    const auto at = [&](std::size_t i) { return Eigen::Vector3d(vertices[t[i]].cast<double>()); };
    const Eigen::Vector3d p = point.cast<double>();
    return (detail::closestOnTriangle(at(0), at(1), at(2), p).point - p).norm();
}

/// Every vertex has its nearest triangle first, if that is within the distance, and is not listed else.
void expectNearest(const std::vector<FacingPlace>& places, const FacingVertices& asking, const FacingVertices& asked,
                   const std::vector<Triangle>& triangles, double distance) {
    std::map<std::uint32_t, FacingPlace> first;
    std::map<std::uint32_t, int> count;
    for (const FacingPlace& place : places) {
        first.emplace(place.vertex, place);
        EXPECT_LE(++count[place.vertex], 3);
        EXPECT_NEAR(facingDistance(asking[place.vertex], asked, triangles[place.triangle]), place.distance, 1e-5);
    }
    for (std::uint32_t v = 0; v < asking.size(); ++v) {
        double nearest = 1e9;
        for (const Triangle& t : triangles) {
            nearest = std::min(nearest, facingDistance(asking[v], asked, t));
        }
        if (std::abs(nearest - distance) > 1e-5 && nearest > 1e-6) {
            ASSERT_EQ(first.contains(v), nearest < distance) << v;
        }
        if (first.contains(v)) {
            EXPECT_NEAR(static_cast<double>(first[v].distance), nearest, 1e-5);
        }
    }
}

/// Pairs that touch at one of some times of a way.
std::set<TrianglePair> touching(const std::array<FacingVertices, 3>& a, const std::array<FacingVertices, 3>& b,
                                const FacingSheet& sheetA, const FacingSheet& sheetB) {
    std::set<TrianglePair> found;
    const auto at = [](const std::array<FacingVertices, 3>& ways, std::uint32_t v, float time) {
        const FacingVertices& from = time < 1 ? ways[0] : ways[1];
        const FacingVertices& to = time < 1 ? ways[1] : ways[2];
        const float share = time < 1 ? time : time - 1;
        return Eigen::Vector3d((from[v] + share * (to[v] - from[v])).cast<double>());
    };
    for (const float time : {0.0F, 0.37F, 0.8F, 1.0F, 1.4F, 1.9F, 2.0F}) {
        for (std::uint32_t i = 0; i < sheetA.triangles.size(); ++i) {
            for (std::uint32_t k = 0; k < sheetB.triangles.size(); ++k) {
                const Triangle& s = sheetA.triangles[i];
                const Triangle& t = sheetB.triangles[k];
                const Corners first{at(a, s[0], time), at(a, s[1], time), at(a, s[2], time)};
                const Corners second{at(b, t[0], time), at(b, t[1], time), at(b, t[2], time)};
                if (trianglesOverlap(first, second)) {
                    found.insert({i, k});
                }
            }
        }
    }
    return found;
}

TEST(Facing, FindsWhatIsNearestAndWhatMeets) {
    const FacingSheet lower(9, 0);
    const FacingSheet upper(7, 0.2F);
    const BallTree a = buildBallTree(lower.view());
    const BallTree b = buildBallTree(upper.view());
    FacingQuery query(a, b);
    FacingResult result;
    std::size_t met = 0;
    for (const float down : {0.0F, 0.1F, 0.3F}) {
        const std::array<FacingVertices, 3> ofA{lower.vertices, lower.movedBy({0, 0.05F, 0}, 0.1F),
                                                lower.movedBy({0.02F, -0.1F, 0}, 0.2F)};
        const std::array<FacingVertices, 3> ofB{upper.vertices, upper.movedBy({0, -down, 0.01F}, -0.1F),
                                                upper.movedBy({0, -2 * down, 0}, 0.1F)};
        query.find({ofA[0], ofA[1], ofA[2], measureStretch(a.surface, ofA[1])},
                   {ofB[0], ofB[1], ofB[2], measureStretch(b.surface, ofB[1])}, 0.25F, 0, nullptr, result);
        ASSERT_FALSE(result.fault);
        expectNearest(result.ofA, ofA[2], ofB[2], upper.triangles, 0.25);
        expectNearest(result.ofB, ofB[2], ofA[2], lower.triangles, 0.25);
        const std::set<TrianglePair> truth = touching(ofA, ofB, lower, upper);
        met += truth.size();
        EXPECT_TRUE(std::ranges::includes(result.meeting, truth)) << down;
        EXPECT_LT(result.meeting.size(), lower.triangles.size() * upper.triangles.size() / 2);
    }
    EXPECT_GT(met, 20U);
}

TEST(Facing, WhatMovesTogetherDoesNotMeet) {
    const FacingSheet lower(12, 0);
    const FacingSheet upper(12, 0.05F);
    const BallTree a = buildBallTree(lower.view());
    const BallTree b = buildBallTree(upper.view());
    FacingQuery query(a, b);
    FacingResult result;
    const auto fallen = [](const FacingSheet& sheet, float by) { return sheet.movedBy({0, -by, 0}, 0.05F * by); };
    const FacingVertices beforeA = fallen(lower, 1);
    const FacingVertices afterA = fallen(lower, 2);
    const FacingVertices beforeB = fallen(upper, 1);
    const FacingVertices afterB = fallen(upper, 2);
    query.find({lower.vertices, beforeA, afterA, measureStretch(a.surface, beforeA)},
               {upper.vertices, beforeB, afterB, measureStretch(b.surface, beforeB)}, 0.1F, 0, nullptr, result);
    // By the longest ways, of a metre, all would be near.
    EXPECT_LT(result.meeting.size(), lower.triangles.size() * upper.triangles.size() / 20);
    EXPECT_GT(result.ofA.size(), 100U);
    EXPECT_GE(result.ofB.size(), upper.vertices.size());
}

TEST(Facing, OfOneWithItselfNeighboursDoNotFaceEachOther) {
    FacingSheet sheet(8, 0);
    const BallTree tree = buildBallTree(sheet.view());
    IndexLists apart;  // the whole row and its neighbours
    apart.begin.push_back(0);
    for (std::uint32_t v = 0; v < sheet.vertices.size(); ++v) {
        for (std::uint32_t w = 0; w < sheet.vertices.size(); ++w) {
            if ((sheet.vertices[v] - sheet.vertices[w]).norm() < 0.8F) {
                apart.all.push_back(w);
            }
        }
        apart.begin.push_back(static_cast<std::uint32_t>(apart.all.size()));
    }
    FacingVertices folded = sheet.vertices;
    for (Eigen::Vector3f& v : folded) {
        v = v.x() > 0 ? Eigen::Vector3f(-v.x(), 0.3F, v.z()) : v;
    }
    FacingQuery query(tree, tree);
    FacingResult result;
    const SurfaceWay way{folded, folded, folded, measureStretch(tree.surface, folded)};
    query.find(way, way, 0.5F, 0, &apart, result);
    ASSERT_FALSE(result.fault);
    EXPECT_GT(result.ofA.size(), 20U);
    for (const FacingPlace& place : result.ofA) {
        for (const std::uint32_t corner : sheet.triangles[place.triangle]) {
            EXPECT_FALSE(std::ranges::binary_search(apart.of(place.vertex), corner));
        }
    }
    query.find(way, way, 0.5F, 0, nullptr, result);
    EXPECT_EQ(result.fault, Fault::badSetting);
    query.find({folded, folded, {}, 1}, way, 0.5F, 0, &apart, result);
    EXPECT_EQ(result.fault, Fault::topologyChanged);
}

TEST(Facing, WhatCostsTooMuchIsGivenUp) {
    const FacingSheet lower(20, 0);
    const FacingSheet upper(20, 0.05F);
    const BallTree a = buildBallTree(lower.view());
    const BallTree b = buildBallTree(upper.view());
    FacingQuery query(a, b);
    FacingResult whole;
    FacingResult result;
    const SurfaceWay wayA{lower.vertices, lower.vertices, lower.vertices, 1};
    const SurfaceWay wayB{upper.vertices, upper.vertices, upper.vertices, 1};
    query.find(wayA, wayB, 0.1F, 0, nullptr, whole);
    ASSERT_TRUE(whole.complete);
    ASSERT_GT(whole.work, 200U);
    for (const std::uint64_t most : {std::uint64_t{0}, whole.work / 2, whole.work - 1}) {
        query.find(wayA, wayB, 0.1F, 0, nullptr, result, most);
        EXPECT_FALSE(result.complete);
        EXPECT_LE(result.work, most + 40);
        EXPECT_TRUE(result.ofA.empty() && result.ofB.empty() && result.meeting.empty());
    }
    query.find(wayA, wayB, 0.1F, 0, nullptr, result, whole.work);
    EXPECT_TRUE(result.complete);
    EXPECT_EQ(result.ofA.size(), whole.ofA.size());
    EXPECT_EQ(result.work, whole.work);
}

}  // namespace
}  // namespace grapeshot::test
