#include <grapeshot/narrowphase/pair_bytes.hpp>

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include <grapeshot/adb/tree_file.hpp>
#include <scenes/shapes.hpp>

namespace grapeshot {
namespace {

std::vector<std::byte> bytesOf(const PairState& state) {
    std::vector<std::byte> bytes;
    ByteWriter out(bytes);
    save(state, out);
    return bytes;
}

struct SavedPairState : testing::Test {
    MeshModel a = makeTrackedModel(scenes::torus(0.6F, 0.2F, 40, 20).view());
    MeshModel b = makeTrackedModel(scenes::bumpySphere(0.4F, 0.08F, 5, 12).view());

    static Pose poseAt(int step) {
        const auto t = static_cast<float>(step);
        return {Eigen::AngleAxisf(0.02F * t, Eigen::Vector3f(0.1F, 1, 0.2F).normalized()).toRotationMatrix(),
                {0.1F, 0.45F + 0.02F * std::sin(0.2F * t), 0.003F * t}};
    }
};

struct SavedPairByMethod : SavedPairState, testing::WithParamInterface<Method> {};

TEST_P(SavedPairByMethod, GoesOnWithTheSameBytesUnderAnyBudget) {
    for (const std::uint64_t work : {std::uint64_t{4}, std::uint64_t{20}, std::uint64_t{300}, unlimited}) {
        PairSettings settings;
        settings.method = GetParam();
        settings.features.searchWork = 160;
        settings.set.regions.spacing = 0.2F;
        PairState whole;
        bool searching = false;
        bool tracking = false;
        for (int step = 0; step < 40; ++step) {
            const std::vector<std::byte> bytes = bytesOf(whole);
            searching = searching || whole.traversal.has_value();
            tracking = tracking || whole.tracker.has_value();
            ByteReader in(bytes);
            PairState loaded = loadPairState(in, {&a, &b});
            EXPECT_EQ(in.left(), 0U);
            EXPECT_EQ(bytesOf(loaded), bytes);
            const PairResult expected = update(a, b, poseAt(step), settings, {.work = work}, whole);
            const PairResult found = update(a, b, poseAt(step), settings, {.work = work}, loaded);
            EXPECT_EQ(found.work, expected.work);
            EXPECT_EQ(found.stop, expected.stop);
            EXPECT_EQ(bytesOf(loaded), bytesOf(whole)) << "work " << work << ", step " << step;
        }
        // So few units are not enough for scf to look into two leaves.
        EXPECT_EQ(hasPoints(whole.contacts), GetParam() != Method::scf || work >= 300);
        EXPECT_EQ(searching, GetParam() != Method::scf && work < unlimited);
        EXPECT_EQ(tracking, GetParam() == Method::scf && work >= 300);
    }
}

INSTANTIATE_TEST_SUITE_P(AllMethods, SavedPairByMethod, testing::Values(Method::automatic, Method::adb, Method::scf),
                         [](const auto& method) { return std::string(name(method.param)); });

TEST_F(SavedPairState, FeaturesAreLeftOutWhereAMeshHasNone) {
    PairSettings settings;
    settings.method = Method::scf;
    settings.features.searchWork = 160;
    PairState state;
    for (int step = 0; step < 5; ++step) {
        update(a, b, poseAt(step), settings, {}, state);
    }
    ASSERT_TRUE(state.tracker);
    const MeshModel plain = makeModel(b.tree.mesh());
    std::vector<std::byte> bytes = bytesOf(state);
    ByteReader in(bytes);
    PairState loaded = loadPairState(in, {&a, &plain});
    EXPECT_FALSE(loaded.tracker);
    EXPECT_EQ(update(a, plain, poseAt(5), settings, {}, loaded).method, Method::adb);
    bytes[bytes.size() - 4] ^= std::byte{1};  // within the tracker's
    ByteReader damaged(bytes);
    EXPECT_THROW((void)loadPairState(damaged, {&a, &b}), Error);
}

TEST_F(SavedPairState, WithOtherTreesTheSearchBeginsAnewAndContactsStay) {
    PairSettings settings;
    PairState state;
    for (int step = 0; step < 5; ++step) {
        update(a, b, poseAt(step), settings, {.work = 20}, state);
    }
    ASSERT_TRUE(hasPoints(state.contacts));
    const MeshModel coarser = makeModel(a.tree.mesh(), {.maxLeafTriangles = 1});
    ASSERT_NE(contentKey(coarser.tree), contentKey(a.tree));
    ASSERT_EQ(contentKey(coarser.tree.mesh()), contentKey(a.tree.mesh()));
    const std::vector<std::byte> bytes = bytesOf(state);
    ByteReader in(bytes);
    PairState loaded = loadPairState(in, {&coarser, &b, false});
    EXPECT_TRUE(hasPoints(loaded.contacts));
    EXPECT_TRUE(loaded.candidates.empty());
    EXPECT_FALSE(loaded.traversal);
    EXPECT_FALSE(loaded.searchHolds);
    const PairResult result = update(coarser, b, poseAt(5), settings, {}, loaded);
    EXPECT_TRUE(result.certain);
}

TEST_F(SavedPairState, CutOffOrOfSmallerMeshesHasAName) {
    PairSettings settings;
    PairState state;
    for (int step = 0; step < 5; ++step) {
        update(a, b, poseAt(step), settings, {.work = 40}, state);
    }
    const std::vector<std::byte> bytes = bytesOf(state);
    for (std::size_t size = 0; size < bytes.size(); size += 13) {
        ByteReader in{std::span(bytes).first(size)};
        EXPECT_THROW(static_cast<void>(loadPairState(in, {&a, &b})), Error) << size;
    }
    const MeshModel tiny = makeModel(scenes::box({1, 1, 1}).view());
    ByteReader in(bytes);
    EXPECT_THROW(static_cast<void>(loadPairState(in, {&tiny, &tiny})), Error);
    ByteReader solid(bytes);
    EXPECT_THROW(static_cast<void>(loadPairState(solid, {&a, nullptr})), Error);
}

}  // namespace
}  // namespace grapeshot
