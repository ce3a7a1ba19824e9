// Presets as documented, and faults by name.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include <grapeshot/adb/reference/adb_query.hpp>
#include <grapeshot/adb/reference/exact_query.hpp>
#include <grapeshot/core/error.hpp>
#include <scenes/shapes.hpp>

namespace grapeshot::reference {
namespace {

void expectFault(Fault fault, const std::string& words, const std::function<void()>& act) {
    try {
        act();
        ADD_FAILURE() << "no fault; expected " << words;
    } catch (const Error& error) {
        EXPECT_EQ(error.fault(), fault) << error.what();
        EXPECT_THAT(error.what(), testing::HasSubstr(words));
    }
}

TEST(Presets, DifferAsPrinted) {
    EXPECT_EQ(chapter2007().kMin, 10);
    EXPECT_EQ(chapter2007().insert, Insert::positive);
    EXPECT_EQ(star().kMin, 1);
    EXPECT_EQ(star().insert, Insert::positive);
    EXPECT_EQ(slide().kMin, 1);
    EXPECT_EQ(slide().insert, Insert::overlapping);
    for (const Settings& settings : {slide(), chapter2007(), star()}) {
        EXPECT_EQ(settings.pMin, 0.99);
        EXPECT_EQ(settings.mostCells, 10);
        EXPECT_EQ(settings.leafPairs, LeafPairs::drop);
        EXPECT_EQ(settings.unequalPairs, UnequalPairs::drop);
        EXPECT_EQ(settings.lowerBound, LowerBound::depth);
        EXPECT_TRUE(settings.nestedEvidence);
        EXPECT_NO_THROW(requireUsable(settings));
    }
}

TEST(Settings, OutOfRangeAreNamed) {
    const auto tree = bounded<Box>(buildHierarchy(scenes::box({1, 1, 1}).view()));
    const CellCounts cells = countCells(tree);
    const auto query = [&](auto change) {
        return [&, change] {
            Settings settings;
            change(settings);
            AdbQuery<Box>({tree, cells}, {tree, cells}, settings);
        };
    };
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const double p : {-0.01, 1.01, nan}) {
        expectFault(Fault::badSetting, "pMin", query([p](Settings& s) { s.pMin = p; }));
    }
    for (const int k : {0, -3}) {
        expectFault(Fault::badSetting, "kMin", query([k](Settings& s) { s.kMin = k; }));
    }
    for (const int x : {0, 11}) {
        expectFault(Fault::badSetting, "mostCells", query([x](Settings& s) { s.mostCells = x; }));
    }
    for (const double tau : {0.0, -1.0, nan}) {
        expectFault(Fault::badSetting, "tau", [&] { static_cast<void>(countCells(tree, {4, tau})); });
    }
    for (const int grid : {0, -1, 17}) {
        expectFault(Fault::badSetting, "grid", [&] { static_cast<void>(countCells(tree, {grid, 0.5})); });
    }
    expectFault(Fault::badSetting, "mostPerLeaf", [] {
        static_cast<void>(buildHierarchy(scenes::box({1, 1, 1}).view(), 0));
    });
}

TEST(Meshes, ThatAreUnusableAreNamed) {
    expectFault(Fault::emptyMesh, "emptyMesh", [] { static_cast<void>(buildHierarchy(MeshView())); });
    scenes::Mesh mesh = scenes::box({1, 1, 1});
    mesh.vertices[3].y() = std::numeric_limits<float>::quiet_NaN();
    expectFault(Fault::notFinite, "vertex 3", [&] { static_cast<void>(buildHierarchy(mesh.view())); });
}

TEST(Poses, ThatAreUnusableAreNamed) {
    const auto tree = bounded<Box>(buildHierarchy(scenes::box({1, 1, 1}).view()));
    const CellCounts cells = countCells(tree);
    AdbQuery<Box> query({tree, cells}, {tree, cells}, {});
    ExactQuery<Box> exact(tree, tree);
    Pose pose;
    pose.translation.z() = std::numeric_limits<float>::quiet_NaN();
    expectFault(Fault::notFinite, "pose", [&] { static_cast<void>(query.decide(pose)); });
    expectFault(Fault::notFinite, "pose", [&] { static_cast<void>(exact.decide(pose)); });
    pose = {};
    pose.rotation *= 2;
    expectFault(Fault::notRigid, "pose", [&] { static_cast<void>(query.decide(pose)); });
}

}  // namespace
}  // namespace grapeshot::reference
