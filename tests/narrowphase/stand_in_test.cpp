#include <grapeshot/narrowphase/stand_in.hpp>

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <grapeshot/narrowphase/pair_update.hpp>
#include <scenes/shapes.hpp>
#include <support/poses.hpp>

namespace grapeshot {
namespace {

MeshModel modelFrom(const scenes::Mesh& mesh) {
    return makeModel(mesh.view());
}

Pose above(float height, float turn) {
    return {Eigen::AngleAxisf(turn, Eigen::Vector3f(0.3F, 0.2F, 1).normalized()).toRotationMatrix(),
            {0.05F, height, 0}};
}

/// Few units tell which way a body that has landed on another is to be pushed, however fine the meshes are.
TEST(StandIn, PushesTheRightWayAndNotTooFar) {
    const MeshModel floor = modelFrom(scenes::grid(3, 3, 40, 40));
    int found = 0;
    int tried = 0;
    for (const scenes::Mesh& mesh : {scenes::box({0.4F, 0.4F, 0.4F}, 10), scenes::bumpySphere(0.4F, 0.05F, 5, 16),
                                     scenes::bumpySphere(0.4F, 0.05F, 5, 48), scenes::cup(0.4F, 0.06F, 0.7F, 40, 12)}) {
        const MeshModel body = modelFrom(mesh);
        for (int i = 0; i < 20; ++i) {
            const Pose pose = above(0.2F + 0.01F * static_cast<float>(i), 0.3F * static_cast<float>(i));
            std::vector<SurfaceContact> contacts;
            EXPECT_LE(standInContacts(floor, body, pose, {}, 0.03F, standInWork, contacts), standInWork);
            ++tried;
            for (const SurfaceContact& contact : contacts) {
                ++found;
                EXPECT_LT(contact.normal.y(), -0.6F) << "A is pushed down";
                EXPECT_LE(contact.signedDistance, 0);
                EXPECT_GE(contact.signedDistance, -0.03F);
                EXPECT_LT((contact.onA - contact.onB - contact.signedDistance * contact.normal).norm(), 1e-5F);
                EXPECT_LT(std::abs(contact.onB.y()), 0.3F);
                EXPECT_EQ(contact.triangleA, noTriangle);
            }
        }
    }
    EXPECT_GT(found, tried / 2);
}

TEST(StandIn, NothingForBodiesApart) {
    const MeshModel ball = modelFrom(scenes::bumpySphere(0.4F, 0.05F, 5, 16));
    for (const float height : {0.9F, 0.95F, 1.2F}) {
        std::vector<SurfaceContact> contacts;
        standInContacts(ball, ball, above(height, 0.4F), {}, 0.03F, standInWork, contacts);
        EXPECT_TRUE(contacts.empty()) << height;
    }
}

/// With the smallest slice a pair that crosses has a contact from the first step; it goes when the true ones are known.
TEST(StandIn, HoldsAPairUntilItIsKnown) {
    const MeshModel floor = modelFrom(scenes::grid(3, 3, 60, 60));
    const MeshModel ball = modelFrom(scenes::bumpySphere(0.4F, 0.05F, 5, 48));
    const auto points = [](const PairState& state, bool standIns) {
        int count = 0;
        for (const RegionSlot& slot : state.contacts.slots) {
            for (int i = 0; i < slot.count; ++i) {
                count += (slot.points[static_cast<std::size_t>(i)].triangleA == noTriangle) == standIns ? 1 : 0;
            }
        }
        return count;
    };
    const Pose pose = above(0.33F, 0.7F);
    PairState state;
    const PairResult first = update(floor, ball, pose, {}, {.work = 16}, state);
    EXPECT_TRUE(first.collides);
    EXPECT_FALSE(first.certain);
    EXPECT_EQ(points(state, true), 1);
    // Once more for the same pose: it stays.
    update(floor, ball, pose, {}, {.work = 4}, state);
    EXPECT_EQ(points(state, true), 1);
    EXPECT_TRUE(update(floor, ball, pose, {}, {.work = 1000000}, state).certain);
    EXPECT_EQ(points(state, true), 0);
    EXPECT_GT(points(state, false), 0);
    dropStandIns(state.contacts);
    EXPECT_GT(points(state, false), 0);
}

}  // namespace
}  // namespace grapeshot
