#include <grapeshot/narrowphase/model_cache.hpp>

#include <atomic>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include <grapeshot/core/error.hpp>
#include <scenes/shapes.hpp>

namespace grapeshot {
namespace {

using scenes::Mesh;

Mesh cube(float half) {
    return scenes::box(Eigen::Vector3f::Constant(half));
}

TEST(ModelCache, SameContentIsOneModel) {
    ModelCache cache;
    const Mesh first = cube(1);
    const Mesh second = cube(1);  // other addresses
    const auto model = cache.get(first.view());
    EXPECT_EQ(cache.get(second.view()), model);
    EXPECT_NE(cache.get(cube(2).view()), model);
    EXPECT_EQ(cache.counts().hits, 1U);
    EXPECT_EQ(cache.counts().builds, 2U);
    EXPECT_EQ(cache.counts().held, 2U);
}

TEST(ModelCache, SettingsAreContent) {
    ModelCache cache;
    const Mesh mesh = scenes::sphere(1, 4);
    const auto wide = cache.get(mesh.view(), {4, 16});
    const auto narrow = cache.get(mesh.view(), {1, 16});
    EXPECT_NE(wide, narrow);
    EXPECT_LT(wide->tree.leaves.size(), narrow->tree.leaves.size());
}

TEST(ModelCache, ReusedMemoryIsNotMistaken) {
    ModelCache cache;
    Mesh mesh = cube(1);
    const auto before = cache.get(mesh.view());
    for (Eigen::Vector3f& vertex : mesh.vertices) {
        vertex *= 2;  // the caller's buffer changes under the same address
    }
    const auto after = cache.get(mesh.view());
    EXPECT_NE(before, after);
    EXPECT_FLOAT_EQ(before->tree.upper.x(), 1);
    EXPECT_FLOAT_EQ(after->tree.upper.x(), 2);
    for (Eigen::Vector3f& vertex : mesh.vertices) {
        vertex /= 2;
    }
    EXPECT_EQ(cache.get(mesh.view()), before);
}

TEST(ModelCache, HoldsWhatIsUsedAndTheLatestIdleOnes) {
    ModelCache cache(2);
    const auto held = cache.get(cube(1).view());
    for (int i = 2; i <= 5; ++i) {
        (void)cache.get(cube(static_cast<float>(i)).view());
    }
    EXPECT_EQ(cache.counts().builds, 5U);
    EXPECT_EQ(cache.counts().held, 3U);  // the held one, 4 and 5
    EXPECT_EQ(cache.get(cube(1).view()), held);
    (void)cache.get(cube(5).view());
    EXPECT_EQ(cache.counts().builds, 5U);
    (void)cache.get(cube(2).view());  // was dropped
    EXPECT_EQ(cache.counts().builds, 6U);
    cache.clear();
    EXPECT_EQ(cache.counts().held, 1U);
    EXPECT_EQ(cache.get(cube(1).view()), held);
}

TEST(ModelCache, RecentUseCounts) {
    ModelCache cache(2);
    (void)cache.get(cube(1).view());
    (void)cache.get(cube(2).view());
    (void)cache.get(cube(1).view());  // now 2 is the oldest
    (void)cache.get(cube(3).view());
    EXPECT_EQ(cache.counts().builds, 3U);
    (void)cache.get(cube(1).view());
    EXPECT_EQ(cache.counts().builds, 3U);
    (void)cache.get(cube(2).view());
    EXPECT_EQ(cache.counts().builds, 4U);
}

TEST(ModelCache, WithoutIdleOnesOnlyUsersHold) {
    ModelCache cache(0);
    auto model = cache.get(cube(1).view());
    EXPECT_EQ(cache.get(cube(1).view()), model);
    model.reset();
    EXPECT_EQ(cache.counts().held, 0U);
    (void)cache.get(cube(1).view());
    EXPECT_EQ(cache.counts().builds, 2U);
}

TEST(ModelCache, AnErrorLeavesItUnchanged) {
    ModelCache cache;
    const auto good = cache.get(cube(1).view());
    Mesh bad = cube(1);
    bad.vertices[3].y() = std::numeric_limits<float>::quiet_NaN();
    for (int i = 0; i < 2; ++i) {
        try {
            (void)cache.get(bad.view());
            FAIL() << "accepted NaN";
        } catch (const Error& error) {
            EXPECT_EQ(error.fault(), Fault::notFinite);
        }
    }
    EXPECT_THROW((void)cache.get({}), Error);
    EXPECT_THROW((void)cache.get(cube(1).view(), {99, 16}), Error);
    EXPECT_EQ(cache.counts().builds, 1U);
    EXPECT_EQ(cache.counts().held, 1U);
    EXPECT_EQ(cache.get(cube(1).view()), good);
}

TEST(ModelCache, ThreadsShareOneBuild) {
    ModelCache cache(4);
    constexpr int threads = 8;
    constexpr int meshes = 6;
    std::vector<Mesh> mesh;
    for (int i = 0; i < meshes; ++i) {
        mesh.push_back(scenes::bumpySphere(1, 0.2F, 5, 12, static_cast<std::uint32_t>(i + 1)));
    }
    Mesh bad = mesh[0];
    bad.triangles[5][1] = 1U << 30U;
    std::vector<std::vector<std::shared_ptr<const MeshModel>>> got(threads);
    std::atomic<int> faults = 0;
    std::vector<std::thread> pool;
    for (int t = 0; t < threads; ++t) {
        pool.emplace_back([&, t] {
            for (int i = 0; i < meshes; ++i) {
                got[t].push_back(cache.get(mesh[i].view()));
                try {
                    (void)cache.get(bad.view());
                } catch (const Error&) {
                    ++faults;
                }
            }
        });
    }
    for (std::thread& thread : pool) {
        thread.join();
    }
    EXPECT_EQ(faults, threads * meshes);
    EXPECT_EQ(cache.counts().builds, static_cast<std::uint64_t>(meshes));
    EXPECT_EQ(cache.counts().hits, static_cast<std::uint64_t>((threads - 1) * meshes));
    for (int t = 1; t < threads; ++t) {
        EXPECT_EQ(got[t], got[0]);
    }
}

class ModelsOnDisk : public testing::Test {
  protected:
    ModelsOnDisk() { std::filesystem::remove_all(folder); }
    ~ModelsOnDisk() override { std::filesystem::remove_all(folder); }
    std::filesystem::path onlyFile() const {
        EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), std::filesystem::directory_iterator()), 1);
        return std::filesystem::directory_iterator(folder)->path();
    }

    const std::filesystem::path folder =
        std::filesystem::temp_directory_path() /
        (std::string("grapeshot_models_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    const Mesh mesh = scenes::torus(1, 0.3F, 24, 16);
};

TEST_F(ModelsOnDisk, AreReadByTheNextProcess) {
    ModelCache first(4, folder);
    const auto built = first.get(mesh.view());
    EXPECT_EQ(first.counts().loads, 0U);
    ModelCache second(4, folder);
    const auto loaded = second.get(mesh.view());
    EXPECT_EQ(second.counts().loads, 1U);
    EXPECT_EQ(second.counts().badFiles, 0U);
    ASSERT_EQ(loaded->tree.nodes.size(), built->tree.nodes.size());
    EXPECT_EQ(std::memcmp(loaded->tree.nodes.data(), built->tree.nodes.data(), built->tree.nodes.size() * sizeof(Node)),
              0);
    EXPECT_EQ(loaded->solid, built->solid);
    EXPECT_EQ(loaded->traits, built->traits);
}

TEST_F(ModelsOnDisk, ABadFileIsIgnoredWithAWarningAndReplaced) {
    static_cast<void>(ModelCache(4, folder).get(mesh.view()));
    const std::filesystem::path file = onlyFile();
    std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2);
    ModelCache cache(4, folder);
    EXPECT_NE(cache.get(mesh.view()), nullptr);
    EXPECT_EQ(cache.counts().badFiles, 1U);
    EXPECT_EQ(cache.counts().loads, 0U);
    EXPECT_NE(cache.lastWarning().find(file.string()), std::string::npos);
    ModelCache next(4, folder);
    static_cast<void>(next.get(mesh.view()));
    EXPECT_EQ(next.counts().loads, 1U);
    EXPECT_EQ(next.lastWarning(), "");
}

TEST_F(ModelsOnDisk, AFolderThatCannotBeUsedCostsOnlyAWarning) {
    std::filesystem::create_directories(folder.parent_path());
    { std::ofstream(folder) << "a file, not a folder"; }
    ModelCache cache(4, folder);
    EXPECT_NE(cache.get(mesh.view()), nullptr);
    EXPECT_EQ(cache.counts().badFiles, 1U);
    EXPECT_NE(cache.lastWarning(), "");
}

}  // namespace
}  // namespace grapeshot
