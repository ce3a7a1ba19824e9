#include <grapeshot/core/pose.hpp>

#include <gtest/gtest.h>

#include <limits>

#include <support/poses.hpp>

namespace grapeshot::test {
namespace {

Pose somePose(Random& random) {
    return {random.rotation(), random.direction() * static_cast<float>(random.uniform(0, 5))};
}

TEST(Pose, InverseUndoesIt) {
    Random random(1);
    for (int i = 0; i < 1000; ++i) {
        const Pose pose = somePose(random);
        const Eigen::Vector3f point = 3 * random.direction();
        EXPECT_LE((apply(inverse(pose), apply(pose, point)) - point).norm(), 1e-5F);
    }
}

TEST(Pose, ComposeIsOneAfterTheOther) {
    Random random(2);
    for (int i = 0; i < 1000; ++i) {
        const Pose bInA = somePose(random);
        const Pose cInB = somePose(random);
        const Eigen::Vector3f point = 3 * random.direction();
        EXPECT_LE((apply(compose(bInA, cInB), point) - apply(bInA, apply(cInB, point))).norm(), 1e-5F);
        EXPECT_TRUE(isRigid(compose(bInA, cInB)));
    }
}

TEST(IsRigid, RefusesWhatIsNoMotion) {
    Random random(3);
    const Pose good = somePose(random);
    EXPECT_TRUE(isRigid(good));
    EXPECT_TRUE(isRigid(Pose{}));

    for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        for (int i = 0; i < 9; ++i) {
            Pose pose = good;
            pose.rotation(i / 3, i % 3) = bad;
            EXPECT_FALSE(isRigid(pose));
        }
        for (int i = 0; i < 3; ++i) {
            Pose pose = good;
            pose.translation[i] = bad;
            EXPECT_FALSE(isRigid(pose));
        }
    }
    Pose mirrored = good;
    mirrored.rotation.col(1) = -mirrored.rotation.col(1);
    EXPECT_FALSE(isRigid(mirrored));
    Pose zero = good;
    zero.rotation.setZero();
    EXPECT_FALSE(isRigid(zero));
    Pose huge = good;
    huge.rotation *= 1e30F;  // squares overflow single precision
    EXPECT_FALSE(isRigid(huge));
    Pose scaled = good;
    scaled.rotation *= 1.01F;
    EXPECT_FALSE(isRigid(scaled));
    EXPECT_TRUE(isRigid(scaled, 0.05F));
    Pose drifted = good;
    drifted.rotation *= 1.0001F;
    EXPECT_TRUE(isRigid(drifted));
}

}  // namespace
}  // namespace grapeshot::test
