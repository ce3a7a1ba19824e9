// What the guard of carried bodies leaves of a step, by the judge of edges and triangles.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <functional>

#include <scenes/shapes.hpp>
#include <soft/crossing_guard.hpp>
#include <soft/crossings.hpp>

namespace grapeshot::test {
namespace {

using Eigen::Vector3d;
using soft::CoreNodes;
using soft::Obstacle;

/// Square sheets of a metre, one above the other, 5 cm apart, each vertex a node.
struct Sheets {
    explicit Sheets(int count) {
        for (int sheet = 0; sheet < count; ++sheet) {
            const scenes::Mesh grid = scenes::grid(0.5F, 0.5F, 10, 10);
            const auto first = static_cast<std::uint32_t>(nodes.before.size());
            for (const Eigen::Vector3f& vertex : grid.vertices) {
                surface.shares.push_back({static_cast<std::uint32_t>(nodes.before.size()), 1});
                surface.ends.push_back(static_cast<std::uint32_t>(surface.shares.size()));
                nodes.before.emplace_back(vertex.cast<double>() + 0.05 * sheet * Vector3d::UnitY());
            }
            for (const Triangle& t : grid.triangles) {
                surface.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
            }
        }
        nodes.now = nodes.before;
        nodes.inverseMass.assign(nodes.before.size(), 1);
        perSheet = nodes.before.size() / static_cast<std::size_t>(count);
    }
    void move(const std::function<Vector3d(const Vector3d&, bool upper)>& way) {
        for (std::size_t i = 0; i < nodes.now.size(); ++i) {
            nodes.now[i] += way(nodes.now[i], i >= perSheet);
        }
    }
    [[nodiscard]] std::size_t crossings() const {
        const soft::Surface now{nodes.now, surface.triangles};
        return soft::crossings(now, now);
    }
    soft::CarriedSurface surface;
    CoreNodes nodes;
    std::size_t perSheet = 0;
};

TEST(CrossingGuard, LeavesWhatDoesNotCross) {
    Sheets sheets(2);
    sheets.move([](const Vector3d& x, bool upper) { return Vector3d(0, upper ? -0.04 * (x.x() + 0.5) : 0, 0); });
    const std::vector<Vector3d> wanted = sheets.nodes.now;
    soft::CrossingGuard guard(sheets.surface, sheets.nodes);
    const soft::GuardResult result = guard.hold(sheets.nodes, {});
    EXPECT_EQ(result.held, 0);
    EXPECT_EQ(sheets.nodes.now, wanted);
}

TEST(CrossingGuard, HoldsBackWhatWouldPassThroughAndNoMore) {
    Sheets sheets(2);
    // Half of the upper one goes through the lower one.
    sheets.move([](const Vector3d& x, bool upper) { return Vector3d(0, upper ? -0.08 * (x.x() + 0.5) : 0, 0); });
    EXPECT_GT(sheets.crossings(), 0U);
    const std::vector<Vector3d> wanted = sheets.nodes.now;
    soft::CrossingGuard guard(sheets.surface, sheets.nodes);
    const soft::GuardResult result = guard.hold(sheets.nodes, {});
    EXPECT_EQ(sheets.crossings(), 0U);
    EXPECT_EQ(result.crossing, 0);
    EXPECT_GT(result.held, 0);
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        if (wanted[i].x() < 0) {
            EXPECT_EQ(sheets.nodes.now[i], wanted[i]) << i;
        }
    }
}

TEST(CrossingGuard, TellsWhatCrossedBefore) {
    Sheets sheets(2);
    const auto part = [](double x) {
        return [x](const Vector3d& at, bool upper) {
            return Vector3d(0, upper && std::abs(at.x() - x) < 0.11 ? -0.08 : 0, 0);
        };
    };
    sheets.move([](const Vector3d&, bool upper) { return Vector3d(upper ? 0.017 : 0, 0, upper ? 0.013 : 0); });
    sheets.move(part(-0.35));
    const std::size_t old = sheets.crossings();
    EXPECT_GT(old, 0U);
    sheets.nodes.before = sheets.nodes.now;
    sheets.move(part(0.35));  // takes rounds in which nobody looks at the others any more
    EXPECT_GT(sheets.crossings(), old);
    soft::CrossingGuard guard(sheets.surface, sheets.nodes);
    const soft::GuardResult result = guard.hold(sheets.nodes, {});
    EXPECT_GE(result.crossing, static_cast<int>(old));  // an edge once for each of its triangles
    EXPECT_EQ(sheets.crossings(), old);
}

TEST(CrossingGuard, SeesAFoldBetweenNeighbours) {
    Sheets sheets(1);
    // One half turns over and through the other.
    sheets.move([](const Vector3d& x, bool) {
        return x.x() > 0.05 ? Vector3d(-2 * x.x(), 0.1 * (x.z() + 0.03), 0) : Vector3d(0, 0, 0);
    });
    EXPECT_GT(sheets.crossings(), 0U);
    soft::CrossingGuard guard(sheets.surface, sheets.nodes);
    EXPECT_GT(guard.hold(sheets.nodes, {}).held, 0);
    EXPECT_EQ(sheets.crossings(), 0U);
}

TEST(CrossingGuard, TakesAlongWhatARigidBodyRunsInto) {
    Sheets sheets(2);
    const scenes::Mesh box = scenes::box({0.1F, 0.1F, 0.1F}, 2);
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.2, Vector3d::UnitY()).toRotationMatrix();
    const auto at = [&](const Vector3d& v) -> Vector3d { return turn * v + Vector3d(0, 0.06, 0); };
    Obstacle obstacle;
    for (const Eigen::Vector3f& vertex : box.vertices) {
        obstacle.points.push_back(at(vertex.cast<double>() + Vector3d(0, -0.15, 0)));
    }
    obstacle.triangles = &box.triangles;
    obstacle.turn = turn;
    obstacle.shift = {0, 0.06, 0};
    const soft::Surface rigid{obstacle.points, box.triangles};
    const auto pierced = [&] { return soft::crossingsOfBoth({sheets.nodes.now, sheets.surface.triangles}, rigid); };
    EXPECT_GT(pierced(), 0U);  // the lower sheet at 0, the box's top from -.05 to .01
    soft::CrossingGuard guard(sheets.surface, sheets.nodes);
    const soft::GuardResult result = guard.hold(sheets.nodes, std::span(&obstacle, 1));
    EXPECT_EQ(pierced(), 0U);
    EXPECT_EQ(sheets.crossings(), 0U);
    EXPECT_EQ(result.crossing, 0);
}

TEST(CrossingGuard, EndsWhereThereIsNoWayOut) {
    Sheets sheets(2);
    for (std::size_t i = 0; i < sheets.perSheet; ++i) {
        sheets.nodes.before[i].y() += 0.1 * (sheets.nodes.before[i].x() + 0.53);
    }
    sheets.nodes.now = sheets.nodes.before;
    EXPECT_GT(sheets.crossings(), 0U);
    soft::CrossingGuard guard(sheets.surface, sheets.nodes);
    EXPECT_GT(guard.hold(sheets.nodes, {}).crossing, 0);
}

}  // namespace
}  // namespace grapeshot::test
