// Impacts of odd input and of odd meshes.
#include <gtest/gtest.h>

#include <limits>
#include <utility>

#include <adb/meshes.hpp>
#include <scf/continuous_scenes.hpp>

namespace grapeshot::test {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

void expectRefused(ImpactQuery& query, const SurfaceMotion& a, const SurfaceMotion& b, const ImpactSettings& settings,
                   Fault fault) {
    const ImpactResult result = query.find(a, b, settings);
    EXPECT_EQ(result.stop, StopReason::invalidInput);
    EXPECT_EQ(result.fault, fault);
    EXPECT_FALSE(result.impact);
    EXPECT_FALSE(result.certain);
    EXPECT_EQ(result.freeUntil, 0);
}

TEST(ImpactOddInput, IsNamed) {
    const PassingPair scene;
    const PassingPair::Event event = scene.event(2);
    ImpactQuery query(scene.a, scene.b);
    const SurfaceMotion a = event.a.motion();
    const SurfaceMotion b = event.b.motion();
    SurfaceMotion wrong = a;
    wrong.now = wrong.now.first(wrong.now.size() - 1);
    expectRefused(query, wrong, b, fineSettings, Fault::topologyChanged);
    wrong = a;
    std::vector<Triangle> changed = scene.meshA.triangles;
    std::swap(changed[3][0], changed[3][1]);
    wrong.triangles = changed;
    expectRefused(query, wrong, b, fineSettings, Fault::topologyChanged);
    wrong.triangles = scene.meshA.triangles;
    EXPECT_FALSE(query.find(wrong, b, fineSettings).fault);
    for (const Stretch& stretch : {Stretch::measured(), Stretch::given(3), Stretch::refitted()}) {
        std::vector<Eigen::Vector3f> broken = event.a.now;
        for (Eigen::Vector3f& vertex : broken) {
            vertex[1] = nan;
        }
        expectRefused(query, {event.a.before, broken, {}, stretch, {}}, b, fineSettings, Fault::notFinite);
    }
    wrong = b;
    wrong.frame.from.rotation *= 2;
    expectRefused(query, a, wrong, fineSettings, Fault::notRigid);
    for (Eigen::Vector3f RigidMotion::*part : {&RigidMotion::path, &RigidMotion::turn}) {
        wrong = b;
        (wrong.frame.*part)[2] = nan;
        expectRefused(query, a, wrong, fineSettings, Fault::notFinite);
    }
    wrong = b;
    wrong.frame.turn = {0, 1e6F, 0};
    expectRefused(query, a, wrong, fineSettings, Fault::badSetting);
    wrong = b;
    wrong.stretch = Stretch::given(nan);
    expectRefused(query, a, wrong, fineSettings, Fault::badSetting);
    for (const ImpactSettings& bad :
         {ImpactSettings{.maxDistance = -1}, ImpactSettings{.maxDistance = nan}, ImpactSettings{.tolerance = 0},
          ImpactSettings{.exclusion = -1}, ImpactSettings{.auditShare = nan}}) {
        expectRefused(query, a, b, bad, Fault::badSetting);
    }
}

TEST(ImpactOddInput, OddMeshesAreAsAnyOther) {
    Random random(9);
    const std::vector<scenes::Mesh> meshes{
        soup(60, 0.3F, 5),
        copiesOfOne(20),
        scenes::merged(scenes::sphere(0.3F, 2), scenes::sphere(0.3F, 2), {0.7F, 0.1F, 0}),
        {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 0, 1}, {2, 2, 2}}}};
    int hits = 0;
    int clear = 0;
    for (const scenes::Mesh& first : meshes) {
        for (const scenes::Mesh& second : meshes) {
            const BallTree a = buildBallTree(first.view());
            const BallTree b = buildBallTree(second.view());
            ImpactQuery query(a, b);
            for (int round = 0; round < 8; ++round) {
                const MovingBody one = passingBody(first, 0.3, random);
                const MovingBody two = passingBody(second, random.uniform(1, 3), random);
                const double truth = meshImpact(one.exact(), two.exact());
                const ImpactResult result = query.find(one.motion(), two.motion(), fineSettings);
                ASSERT_TRUE(result.certain);
                ASSERT_EQ(result.impact.has_value(), truth != noImpact);
                if (result.impact) {
                    EXPECT_NEAR(static_cast<double>(result.impact->time), truth, 1e-3);
                }
                ++(result.impact ? hits : clear);
            }
        }
    }
    EXPECT_GT(hits, 20);
    EXPECT_GT(clear, 20);
}

}  // namespace
}  // namespace grapeshot::test
