// Laws of impacts: swapped bodies, moved scenes, time run backwards, budgets, same bytes; and odd input.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

#include <grapeshot/core/bytes.hpp>
#include <grapeshot/core/rate_bound.hpp>
#include <grapeshot/scf/detail/impact_search.hpp>

#include <adb/meshes.hpp>
#include <scf/continuous_scenes.hpp>
#include <support/test_size.hpp>

namespace grapeshot::test {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

/// Two bumpy spheres that pass or meet, and their trees.
struct Scene {
    explicit Scene(int frequency = 8)
        : meshA(scenes::normalised(scenes::bumpySphere(1, 0.3F, 7, frequency, 3), 1)),
          meshB(scenes::normalised(scenes::bumpySphere(1, 0.25F, 5, frequency, 4), 1)) {}
    scenes::Mesh meshA, meshB;
    BallTree a = buildBallTree(meshA.view());
    BallTree b = buildBallTree(meshB.view());

    struct Event {
        MovingBody a, b;
    };
    [[nodiscard]] Event event(std::uint64_t seed) const {
        Random random(seed);
        return {passingBody(meshA, 0.1, random), passingBody(meshB, random.uniform(0.9, 2.5), random)};
    }
};

constexpr ImpactSettings fine{.tolerance = 1e-6F};

TEST(ImpactLaws, SwappedBodiesMeetAtTheSameTime) {
    const Scene scene;
    int hits = 0;
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        const Scene::Event event = scene.event(seed);
        const ImpactResult one = ImpactQuery(scene.a, scene.b).find(event.a.motion(), event.b.motion(), fine);
        const ImpactResult two = ImpactQuery(scene.b, scene.a).find(event.b.motion(), event.a.motion(), fine);
        ASSERT_EQ(one.impact.has_value(), two.impact.has_value());
        if (one.impact) {
            ++hits;
            EXPECT_NEAR(one.impact->time, two.impact->time, 2e-5);
            EXPECT_LE((one.impact->normal + two.impact->normal).norm(), one.impact->time > 0 ? 0.05F : 3);
        }
    }
    EXPECT_GT(hits, 10);
    EXPECT_LT(hits, 35);
}

TEST(ImpactLaws, MovedAsAWholeItIsTheSameImpact) {
    const Scene scene;
    Random random(17);
    int hits = 0;
    for (std::uint64_t seed = 0; seed < 30; ++seed) {
        const Scene::Event event = scene.event(seed);
        const ImpactResult plain = ImpactQuery(scene.a, scene.b).find(event.a.motion(), event.b.motion(), fine);
        const RigidMotion frame{{random.rotation(), 2 * random.direction()}, 2 * random.direction(), {0, 0, 0}};
        SurfaceMotion a = event.a.motion();
        SurfaceMotion b = event.b.motion();
        a.frame = b.frame = frame;
        const ImpactResult moved = ImpactQuery(scene.a, scene.b).find(a, b, fine);
        ASSERT_EQ(plain.impact.has_value(), moved.impact.has_value());
        if (plain.impact) {
            ++hits;
            EXPECT_NEAR(plain.impact->time, moved.impact->time, 5e-5);
        }
        // Likewise when the frame that both stand in turns.
        a.frame.turn = b.frame.turn = random.direction();
        const ImpactResult turned = ImpactQuery(scene.a, scene.b).find(a, b, fine);
        ASSERT_EQ(plain.impact.has_value(), turned.impact.has_value());
        if (plain.impact) {
            EXPECT_NEAR(plain.impact->time, turned.impact->time, 5e-5);
        }
    }
    EXPECT_GT(hits, 8);
    EXPECT_LT(hits, 28);
}

TEST(ImpactLaws, RunBackwardsItHitsAsWell) {
    const Scene scene;
    int hits = 0;
    int clear = 0;
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        const Scene::Event event = scene.event(seed);
        MovingBody a = event.a;
        MovingBody b = event.b;
        std::swap(a.before, a.now);
        std::swap(b.before, b.now);
        const ImpactResult there = ImpactQuery(scene.a, scene.b).find(event.a.motion(), event.b.motion(), fine);
        const ImpactResult back = ImpactQuery(scene.a, scene.b).find(a.motion(), b.motion(), fine);
        ASSERT_EQ(there.impact.has_value(), back.impact.has_value());
        if (there.impact) {
            // The last touch cannot be before the first one.
            EXPECT_LE(there.impact->time, 1 - back.impact->time + 1e-5F);
            ++hits;
        } else {
            ++clear;
        }
    }
    EXPECT_GT(hits, 10);
    EXPECT_GT(clear, 5);
}

TEST(ImpactLaws, WithoutMotionThereIsTheStartAlone) {
    const Scene scene;
    ImpactQuery query(scene.a, scene.b);
    int touching = 0;
    for (int i = 0; i < 20; ++i) {
        const Pose pose{Eigen::Matrix3f::Identity(), {0.25F + 0.04F * static_cast<float>(i), 0.1F, 0}};
        const bool truth = bruteForceDecide(scene.meshA.view(), scene.meshB.view(), pose);
        const ImpactResult result = query.find(rigidMotion(), rigidMotion({pose, {0, 0, 0}, {0, 0, 0}}), fine);
        ASSERT_TRUE(result.certain);
        ASSERT_EQ(result.impact.has_value(), truth);
        EXPECT_EQ(result.freeUntil, truth ? 0 : 1);
        touching += truth ? 1 : 0;
        // One that touches at the start does so whatever it does then.
        const ImpactResult moving = query.find(rigidMotion(), rigidMotion({pose, {3, 0, 0}, {0, 1, 0}}), fine);
        EXPECT_EQ(moving.impact && moving.impact->time == 0, truth);
    }
    EXPECT_GT(touching, 3);
    EXPECT_LT(touching, 17);
}

TEST(ImpactLaws, MoreBudgetNeverKnowsLess) {
    const Scene scene;
    int early = 0;
    int settled = 0;
    for (std::uint64_t seed = 0; seed < 30; ++seed) {
        const Scene::Event event = scene.event(seed);
        ImpactQuery query(scene.a, scene.b);
        const ImpactResult exact = query.find(event.a.motion(), event.b.motion(), fine);
        const float first = exact.impact ? exact.impact->time : 1;
        float before = 0;
        for (const std::uint64_t work : {0U, 5U, 20U, 60U, 120U, 200U, 350U, 600U, 1000U, 20'000U}) {
            // Without chance the search by time goes on where a shorter one stops.
            ImpactSettings settings = fine;
            settings.auditShare = 0;
            const ImpactResult plain = query.find(event.a.motion(), event.b.motion(), settings, {.work = work});
            EXPECT_GE(plain.freeUntil, before);
            before = plain.freeUntil;
            const ImpactResult result = query.find(event.a.motion(), event.b.motion(), fine, {.work = work});
            EXPECT_LE(result.work, work + 20);
            EXPECT_LE(result.freeUntil, first);
            EXPECT_EQ(result.certain, result.stop == StopReason::certain);
            if (result.impact) {
                ASSERT_TRUE(exact.impact);
                EXPECT_GE(result.impact->time, first - 1e-6F);
                EXPECT_LE(result.freeUntil, result.impact->time);
                early += result.certain ? 0 : 1;
            }
            if (result.certain) {
                ++settled;
                EXPECT_EQ(result.impact.has_value(), exact.impact.has_value());
                EXPECT_NEAR(result.freeUntil, first, 1e-6F);
                EXPECT_EQ(result.freeUntil, result.impact ? result.impact->time : 1);
            } else if (!result.impact && exact.impact) {
                EXPECT_GE(result.miss.missedBound, 1);
            }
        }
    }
    EXPECT_GT(early, 3);
    EXPECT_GT(settled, 50);
}

TEST(ImpactLaws, UnitByUnitFreeUntilNeverFalls) {
    // Fitted balls and a thin box: the balls around its triangles reach out of those of its leaves.
    const scenes::Mesh meshA = scenes::normalised(scenes::bumpySphere(1, 0.3F, 7, 4, 3), 1);
    const scenes::Mesh meshB = scenes::box({0.5F, 0.02F, 0.02F}, 1);
    const BallTree a = buildBallTree(meshA.view());
    const BallTree b = buildBallTree(meshB.view());
    ImpactQuery query(a, b);
    ImpactSettings settings = fine;
    settings.auditShare = 0;
    int steps = 0;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        Random random(seed);
        const MovingBody first = passingBody(meshA, 0.1, random);
        const MovingBody second = passingBody(meshB, random.uniform(0.6, 1.5), random);
        float before = 0;
        for (std::uint64_t work = 0; work < 400; ++work) {
            const ImpactResult result = query.find(first.motion(Stretch::refitted()),
                                                   second.motion(Stretch::refitted()), settings, {.work = work});
            ASSERT_GE(result.freeUntil, before) << seed << " " << work;
            steps += result.freeUntil > before ? 1 : 0;
            before = result.freeUntil;
            if (result.certain) {
                break;
            }
        }
    }
    EXPECT_GT(steps, 100);
}

TEST(ImpactLaws, InPartsTheBudgetIsUsedUpAndTheTimeIsHeld) {
    const Scene scene;
    int inBetween = 0;
    int inTheLast = 0;
    int early = 0;
    int settled = 0;
    for (std::uint64_t seed = 0; seed < 30; ++seed) {
        const Scene::Event event = scene.event(seed);
        SurfaceMotion a = event.a.motion();
        SurfaceMotion b = event.b.motion();
        a.frame.turn = {0.6F, 0, 0.1F};
        b.frame.turn = {0, 1.1F, 0.05F};  // five parts
        ImpactQuery query(scene.a, scene.b);
        const ImpactResult exact = query.find(a, b, fine);
        ASSERT_TRUE(exact.certain);
        const float first = exact.impact ? exact.impact->time : 1;
        float before = 0;
        for (const std::uint64_t work : {20U, 60U, 200U, 500U, 1000U, 2000U, 20'000U}) {
            ImpactSettings settings = fine;
            settings.auditShare = 0;
            const ImpactResult plain = query.find(a, b, settings, {.work = work});
            EXPECT_GE(plain.freeUntil, before);
            before = plain.freeUntil;
            const ImpactResult result = query.find(a, b, fine, {.work = work});
            EXPECT_LE(result.work, work + 20);
            EXPECT_LE(result.freeUntil, first);
            ASSERT_TRUE(exact.impact || !result.impact);
            if (result.impact) {
                EXPECT_GE(result.impact->time, first - 1e-6F);
                early += result.certain ? 0 : 1;
            }
            if (result.certain) {
                ++settled;
                EXPECT_EQ(result.impact.has_value(), exact.impact.has_value());
                EXPECT_NEAR(result.freeUntil, first, 1e-6F);
            } else if (result.freeUntil < 0.79F) {
                ++inBetween;
                EXPECT_GE(result.work, work);
                EXPECT_EQ(result.miss.missedBound, std::numeric_limits<double>::infinity());
            } else {
                ++inTheLast;
                EXPECT_GE(4 * result.work, 3 * work);
            }
        }
    }
    EXPECT_GT(inBetween, 50);
    EXPECT_GT(inTheLast, 3);
    EXPECT_GT(early, 3);
    EXPECT_GT(settled, 30);
}

TEST(ImpactLaws, WithoutBudgetNothingIsKnown) {
    const Scene scene;
    const Scene::Event event = scene.event(1);
    const ImpactResult result =
        ImpactQuery(scene.a, scene.b).find(event.a.motion(), event.b.motion(), fine, {.work = 0});
    EXPECT_EQ(result.work, 0U);
    EXPECT_FALSE(result.impact);
    EXPECT_FALSE(result.certain);
    EXPECT_EQ(result.freeUntil, 0);
    EXPECT_EQ(result.stop, StopReason::budget);
    EXPECT_EQ(result.miss.missedBound, 1);  // the pair of both roots
}

void listTriangles(const BallTree& tree, BallRef ref, std::vector<std::uint32_t>& out) {
    if (isBallLeaf(ref)) {
        const BallLeaf& leaf = tree.leaves[ballIndex(ref)];
        out.insert(out.end(), leaf.triangle, leaf.triangle + leaf.count);
        return;
    }
    const BallNode& node = tree.nodes[ballIndex(ref)];
    for (std::uint32_t slot = 0; slot < node.count; ++slot) {
        listTriangles(tree, node.child[slot], out);
    }
}

/// How many of the pairs that wait have an impact before the limit?
std::uint64_t trueHits(const Scene& scene, const std::vector<TriangleImpact>& impacts, const detail::ImpactFront& front,
                       double limit) {
    const auto below = [](const BallTree& tree, BallRef ref) {
        std::vector<std::uint32_t> list;
        listTriangles(tree, ref, list);
        std::vector<char> isBelow(tree.surface.triangles.size(), 0);
        for (const std::uint32_t t : list) {
            isBelow[t] = 1;
        }
        return isBelow;
    };
    std::uint64_t count = 0;
    for (const detail::WaitingPair& pair : front.pieces) {
        const std::vector<char> belowA = below(scene.a, pair.a);
        const std::vector<char> belowB = below(scene.b, pair.b);
        count += std::ranges::any_of(impacts, [&](const TriangleImpact& impact) {
            return impact.time < limit && belowA[impact.a] != 0 && belowB[impact.b] != 0;
        });
    }
    for (const detail::WaitingPair& pair : front.triangles) {
        const std::uint32_t i = scene.a.leaves[pair.a >> 4U].triangle[pair.a & 15U];
        const std::uint32_t j = scene.b.leaves[pair.b >> 4U].triangle[pair.b & 15U];
        count += std::ranges::any_of(impacts, [&](const TriangleImpact& impact) {
            return impact.time < limit && impact.a == i && impact.b == j;
        });
    }
    return count;
}

TEST(ImpactLaws, TheBoundOnWhatWasMissedHolds) {
    const Scene scene(4);
    detail::MovingTree a(scene.a);
    detail::MovingTree b(scene.b);
    std::uint64_t judged = 0;
    std::uint64_t failed = 0;
    double missed = 0;
    double estimated = 0;
    constexpr std::uint64_t events = 8;
    std::vector<Scene::Event> event;
    std::vector<std::vector<TriangleImpact>> impacts;
    for (std::uint64_t seed = 0; event.size() < events; ++seed) {
        const Scene::Event next = scene.event(seed);
        if (std::vector<TriangleImpact> all = allImpacts(next.a.exact(), next.b.exact()); !all.empty()) {
            event.push_back(next);
            impacts.push_back(std::move(all));
        }
    }
    const std::size_t most = sampleSize(100, 2000);
    for (std::uint64_t seed = 0; judged < most && seed < 40 * most; ++seed) {
        const std::size_t which = seed % events;
        a.begin(event[which].a.motion(), 2.5F, {});
        b.begin(event[which].b.motion(), 2.5F, {});
        detail::Meter meter({.work = 400 + seed % 400});
        detail::ImpactScratch scratch;
        const detail::ImpactSpace space{&a, &b, 0, 1e-6F, -1};
        detail::ImpactSearch search(space, meter, {seed, 1, 2}, 0, 0, scratch);
        if (search.run(385 + seed % 370)) {
            continue;
        }
        const detail::ImpactFront before = scratch.front;
        const double limit = search.impact() ? static_cast<double>(search.impact()->time) : noImpact;
        MissEstimate miss;
        search.audit(miss);
        if (miss.sampled == 0 || miss.sampled == miss.unknown) {
            continue;
        }
        ++judged;
        const std::uint64_t truth = trueHits(scene, impacts[which], before, limit);
        ASSERT_LE(miss.hits, truth);
        failed += static_cast<double>(truth - miss.hits) > miss.missedBound ? 1 : 0;
        if (miss.open == 0) {
            missed += static_cast<double>(truth - miss.hits);
            estimated += miss.missed;
        }
    }
    EXPECT_EQ(judged, most);
    EXPECT_GT(missed, static_cast<double>(judged));
    EXPECT_NEAR(estimated, missed, 0.25 * missed);
    EXPECT_GE(upperRate(judged - failed, judged, 0.99), 0.95);  // not significantly below
}

std::vector<std::byte> bytesOf(const ImpactResult& result) {
    std::vector<std::byte> bytes;
    ByteWriter writer(bytes);
    writer.put(result.freeUntil);
    writer.put(result.certain);
    writer.put(result.work);
    writer.put(result.miss.unknown);
    writer.put(result.miss.hits);
    writer.put(result.miss.missedBound);
    if (result.impact) {
        writer.put(result.impact->time);
        writer.put(result.impact->pair.triangleA);
        writer.put(result.impact->pair.triangleB);
        writer.put(result.impact->featureA);
        writer.put(result.impact->featureB);
        writer.put(result.impact->onA);
        writer.put(result.impact->onB);
        writer.put(result.impact->normal);
    }
    return bytes;
}

TEST(ImpactLaws, SameBytesOnEveryInstructionSetAndAgain) {
    const InstructionSetGuard guard;
    const Scene scene;
    std::vector<std::vector<std::byte>> expected;
    for (int run = 0; run < 2; ++run) {
        for (const InstructionSet set : instructionSets()) {
            limitInstructionSet(set);
            ImpactQuery query(scene.a, scene.b);
            std::vector<std::vector<std::byte>> all;
            std::size_t hits = 0;
            for (std::uint64_t seed = 0; seed < 12; ++seed) {
                const Scene::Event event = scene.event(seed);
                SurfaceMotion turning = event.b.motion();
                turning.frame.turn = {0, 0.4F, 0};
                for (const std::uint64_t work : {std::uint64_t{40}, unlimited}) {
                    for (const SurfaceMotion& b : {event.b.motion(), turning}) {
                        const ImpactResult result = query.find(event.a.motion(), b, fine, {.work = work});
                        hits += result.impact ? 1 : 0;
                        all.push_back(bytesOf(result));
                    }
                }
            }
            expected = expected.empty() ? all : expected;
            EXPECT_EQ(all, expected);
            EXPECT_GE(hits, 8U);
        }
    }
}

TEST(ImpactLaws, DiscreteQueriesMissWhatPassesThrough) {
    // A needle through a sheet: neither end of the step touches.
    const scenes::Mesh sheet = scenes::grid(1, 1, 30, 30);
    const scenes::Mesh needle = scenes::box({0.003F, 0.05F, 0.003F}, 1);
    const BallTree a = buildBallTree(sheet.view());
    const BallTree b = buildBallTree(needle.view());
    const Pose above{Eigen::Matrix3f::Identity(), {0.013F, 0.9F, 0.022F}};
    const Pose below{Eigen::Matrix3f::Identity(), {0.013F, -0.7F, 0.022F}};
    EXPECT_FALSE(bruteForceDecide(sheet.view(), needle.view(), above));
    EXPECT_FALSE(bruteForceDecide(sheet.view(), needle.view(), below));
    ImpactQuery query(a, b);
    const ImpactResult through = query.find(rigidMotion(), rigidMotion(motionBetween(above, below)), fine);
    ASSERT_TRUE(through.impact);
    EXPECT_NEAR(through.impact->time, 0.85 / 1.6, 2e-6);
    EXPECT_NEAR(std::abs(through.impact->normal[1]), 1, 1e-3);
    RigidMotion beside = motionBetween(above, below);
    beside.from.translation[0] += 1;
    EXPECT_FALSE(query.find(rigidMotion(), rigidMotion(beside), fine).impact);
    // Thickness: the sheet's is reached before the sheet.
    ImpactSettings thick = fine;
    thick.maxDistance = 0.1F;
    const ImpactResult earlier = query.find(rigidMotion(), rigidMotion(motionBetween(above, below)), thick);
    ASSERT_TRUE(earlier.impact);
    EXPECT_NEAR(earlier.impact->time, 0.75 / 1.6, 1e-5);
}

TEST(ImpactLaws, MotionsLeadWhereTheyShould) {
    Random random(3);
    for (int i = 0; i < 200; ++i) {
        const Pose from{random.rotation(), random.direction()};
        const Pose to{random.rotation(), random.direction()};
        const RigidMotion motion = motionBetween(from, to);
        EXPECT_LE(motion.turn.norm(), std::numbers::pi_v<float> + 1e-5F);
        const Pose end = poseAt(motion, 1);
        EXPECT_LE((end.rotation - to.rotation).norm(), 2e-6F);
        EXPECT_LE((end.translation - to.translation).norm(), 1e-6F);
        // Half way from both sides, at a constant rate.
        const Pose half = poseAt(motion, 0.5);
        const RigidMotion rest = motionBetween(half, to);
        EXPECT_LE((rest.turn - 0.5F * motion.turn).norm(), 1e-5F);
    }
    const RigidMotion whole{{}, {0, 0, 0}, {0, 0, 2 * std::numbers::pi_v<float>}};
    EXPECT_LE((poseAt(whole, 1).rotation - Eigen::Matrix3f::Identity()).norm(), 1e-6F);
    EXPECT_NEAR(poseAt(whole, 0.25).rotation(1, 0), 1, 1e-6);
}

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
    const Scene scene;
    const Scene::Event event = scene.event(2);
    ImpactQuery query(scene.a, scene.b);
    const SurfaceMotion a = event.a.motion();
    const SurfaceMotion b = event.b.motion();
    SurfaceMotion wrong = a;
    wrong.now = wrong.now.first(wrong.now.size() - 1);
    expectRefused(query, wrong, b, fine, Fault::topologyChanged);
    wrong = a;
    std::vector<Triangle> changed = scene.meshA.triangles;
    std::swap(changed[3][0], changed[3][1]);
    wrong.triangles = changed;
    expectRefused(query, wrong, b, fine, Fault::topologyChanged);
    wrong.triangles = scene.meshA.triangles;
    EXPECT_FALSE(query.find(wrong, b, fine).fault);
    for (const Stretch& stretch : {Stretch::measured(), Stretch::given(3), Stretch::refitted()}) {
        std::vector<Eigen::Vector3f> broken = event.a.now;
        for (Eigen::Vector3f& vertex : broken) {
            vertex[1] = nan;
        }
        expectRefused(query, {event.a.before, broken, {}, stretch, {}}, b, fine, Fault::notFinite);
    }
    wrong = b;
    wrong.frame.from.rotation *= 2;
    expectRefused(query, a, wrong, fine, Fault::notRigid);
    for (Eigen::Vector3f RigidMotion::*part : {&RigidMotion::path, &RigidMotion::turn}) {
        wrong = b;
        (wrong.frame.*part)[2] = nan;
        expectRefused(query, a, wrong, fine, Fault::notFinite);
    }
    wrong = b;
    wrong.frame.turn = {0, 1e6F, 0};
    expectRefused(query, a, wrong, fine, Fault::badSetting);
    wrong = b;
    wrong.stretch = Stretch::given(nan);
    expectRefused(query, a, wrong, fine, Fault::badSetting);
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
                const ImpactResult result = query.find(one.motion(), two.motion(), fine);
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
