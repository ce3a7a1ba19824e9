#include <grapeshot/adb/tree_file.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <iterator>
#include <thread>

#include <grapeshot/core/error.hpp>

#include "scenes/shapes.hpp"
#include "support/poses.hpp"
#include "trees.hpp"

namespace grapeshot {
namespace {

using test::sameBytes;

namespace fs = std::filesystem;

class TreeFile : public testing::Test {
  protected:
    TreeFile() {
        fs::remove_all(folder);
        fs::create_directories(folder);
    }
    ~TreeFile() override { fs::remove_all(folder); }

    std::vector<char> bytes() const {
        std::ifstream stream(file, std::ios::binary);
        return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
    }
    void write(const std::vector<char>& content) const {
        std::ofstream(file, std::ios::binary).write(content.data(), static_cast<std::streamsize>(content.size()));
    }
    /// What loading says, "" if it works.
    std::string complaint() const {
        try {
            static_cast<void>(loadTree(file, mesh.view(), settings));
            return "";
        } catch (const Error& error) {
            EXPECT_EQ(error.fault(), Fault::badFile);
            EXPECT_THAT(error.what(), testing::HasSubstr(file.string()));
            return error.what();
        }
    }

    static constexpr std::size_t header = 232;  ///< bytes
    const fs::path folder =
        fs::temp_directory_path() /
        ("grapeshot_tree_file_" + std::to_string(::testing::UnitTest::GetInstance()->random_seed()) + "_" +
         ::testing::UnitTest::GetInstance()->current_test_info()->name());
    const fs::path file = folder / "a.tree";
    const scenes::Mesh mesh = scenes::bumpySphere(1.0F, 0.2F, 5, 4, 17);
    const BuildSettings settings;
    const Tree tree = build(mesh.view(), settings);
};

TEST_F(TreeFile, ComesBackByteForByte) {
    saveTree(tree, settings, file);
    const Tree loaded = loadTree(file, mesh.view(), settings);
    EXPECT_TRUE(sameBytes(loaded.nodes, tree.nodes));
    EXPECT_TRUE(sameBytes(loaded.distributions, tree.distributions));
    EXPECT_TRUE(sameBytes(loaded.leaves, tree.leaves));
    EXPECT_TRUE(sameBytes(loaded.vertices, tree.vertices));
    EXPECT_TRUE(sameBytes(loaded.triangles, tree.triangles));
    EXPECT_EQ(loaded.lower, tree.lower);
    EXPECT_EQ(loaded.upper, tree.upper);
    EXPECT_EQ(loaded.radius, tree.radius);
    EXPECT_EQ(loaded.whole.unit, tree.whole.unit);
    EXPECT_TRUE(std::ranges::equal(loaded.whole.mean, tree.whole.mean));
    for (std::size_t column = 0; column < 3; ++column) {
        EXPECT_TRUE(std::ranges::equal(loaded.whole.covariance[column], tree.whole.covariance[column]));
    }
    EXPECT_THAT(findings(loaded), testing::IsEmpty());
}

TEST_F(TreeFile, LeavesNothingElseBehind) {
    saveTree(tree, settings, file);
    saveTree(tree, settings, file);  // over the old one
    EXPECT_EQ(std::distance(fs::directory_iterator(folder), fs::directory_iterator()), 1);
}

TEST_F(TreeFile, IsOfOneMeshAndOneSetting) {
    saveTree(tree, settings, file);
    const auto refused = [&](const scenes::Mesh& other, const BuildSettings& wanted) {
        try {
            static_cast<void>(loadTree(file, other.view(), wanted));
            return false;
        } catch (const Error& error) {
            return std::string_view(error.what()).find("another mesh") != std::string_view::npos;
        }
    };
    scenes::Mesh other = mesh;
    EXPECT_FALSE(refused(other, settings));
    other.vertices[3].x() += 1e-6F;
    EXPECT_TRUE(refused(other, settings));
    other = mesh;
    std::swap(other.triangles[0], other.triangles[1]);
    EXPECT_TRUE(refused(other, settings));
    EXPECT_TRUE(refused(mesh, {.maxLeafTriangles = 3, .bins = settings.bins}));
}

TEST_F(TreeFile, AnyCutOffFileIsRefused) {
    saveTree(tree, settings, file);
    const std::vector<char> whole = bytes();
    for (std::size_t size = 0; size < whole.size(); size += size < header ? 1 : whole.size() / 97) {
        write({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)});
        EXPECT_NE(complaint(), "") << size;
    }
    std::vector<char> longer = whole;
    longer.push_back('x');
    write(longer);
    EXPECT_NE(complaint(), "");
    write(whole);
    EXPECT_EQ(complaint(), "");
}

TEST_F(TreeFile, AnyChangedByteIsNoticed) {
    saveTree(tree, settings, file);
    const std::vector<char> whole = bytes();
    for (std::size_t place = 0; place < whole.size(); place += place < header ? 1 : whole.size() / 97) {
        std::vector<char> changed = whole;
        changed[place] = static_cast<char>(changed[place] ^ 0x10);
        write(changed);
        EXPECT_NE(complaint(), "") << place;
    }
}

TEST_F(TreeFile, WildIndicesAreRefusedWithTheirPlace) {
    const auto complaintAbout = [&](Tree damaged) {
        saveTree(damaged, settings, file);
        return complaint();
    };
    Tree damaged = tree;
    damaged.nodes[0].child[0] = 0;  // a circle
    EXPECT_THAT(complaintAbout(damaged), testing::HasSubstr("node 0"));
    damaged = tree;
    damaged.nodes.back().child[0] = leafBit | 0x7fffff00U;
    EXPECT_THAT(complaintAbout(damaged), testing::HasSubstr("node " + std::to_string(tree.nodes.size() - 1)));
    damaged = tree;
    damaged.leaves[5].triangle[0] = static_cast<std::uint32_t>(tree.triangles.size());
    EXPECT_THAT(complaintAbout(damaged), testing::HasSubstr("leaf 5"));
    damaged = tree;
    std::ranges::fill(damaged.leaves[5].triangle, noTriangle);
    EXPECT_THAT(complaintAbout(damaged), testing::HasSubstr("leaf 5"));
    damaged = tree;
    damaged.leaves[5].triangle[0] = damaged.leaves[4].triangle[0];
    EXPECT_THAT(complaintAbout(damaged), testing::HasSubstr("leaf 5"));
    damaged = tree;
    damaged.leaves.push_back(damaged.leaves.back());
    EXPECT_THAT(complaintAbout(damaged), testing::HasSubstr("leaf " + std::to_string(tree.leaves.size())));
}

TEST_F(TreeFile, WhatCannotBeOpenedOrWrittenIsNamed) {
    EXPECT_THAT(complaint(), testing::HasSubstr("cannot be opened"));
    EXPECT_THROW(saveTree(tree, settings, folder / "no such folder" / "a.tree"), Error);
    fs::create_directory(file);  // a folder of that name
    EXPECT_THROW(saveTree(tree, settings, file), Error);
    EXPECT_EQ(std::distance(fs::directory_iterator(folder), fs::directory_iterator()), 1);
    EXPECT_NE(complaint(), "");
}

TEST_F(TreeFile, WritersDoNotDisturbReaders) {
    saveTree(tree, settings, file);
    std::thread writer([&] {
        for (int i = 0; i < 30; ++i) {
            saveTree(tree, settings, file);
        }
    });
    for (int i = 0; i < 30; ++i) {
        EXPECT_EQ(complaint(), "");
    }
    writer.join();
}

}  // namespace
}  // namespace grapeshot
