// Impacts under budgets: what is known, what is not, and whether the bound on what was missed holds.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include <grapeshot/core/rate_bound.hpp>
#include <grapeshot/scf/detail/impact_search.hpp>

#include <scf/continuous_scenes.hpp>
#include <support/test_size.hpp>

namespace grapeshot::test {
namespace {

TEST(ImpactBudget, MoreBudgetNeverKnowsLess) {
    const PassingPair scene;
    int early = 0;
    int settled = 0;
    for (std::uint64_t seed = 0; seed < 30; ++seed) {
        const PassingPair::Event event = scene.event(seed);
        ImpactQuery query(scene.a, scene.b);
        const ImpactResult exact = query.find(event.a.motion(), event.b.motion(), fineSettings);
        const float first = exact.impact ? exact.impact->time : 1;
        float before = 0;
        for (const std::uint64_t work : {0U, 5U, 20U, 60U, 120U, 200U, 350U, 600U, 1000U, 20'000U}) {
            // Without chance the search by time goes on where a shorter one stops.
            ImpactSettings settings = fineSettings;
            settings.auditShare = 0;
            const ImpactResult plain = query.find(event.a.motion(), event.b.motion(), settings, {.work = work});
            EXPECT_GE(plain.freeUntil, before);
            before = plain.freeUntil;
            const ImpactResult result = query.find(event.a.motion(), event.b.motion(), fineSettings, {.work = work});
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

/// What bodies that go far meet is found long before it is proven to be the first.
TEST(ImpactBudget, AFractionOfTheWorkFindsMostImpactsOfFastBodies) {
    const PassingPair scene;
    ImpactQuery query(scene.a, scene.b);
    int hits = 0;
    int found[2] = {};
    for (std::uint64_t seed = 0; seed < 100; ++seed) {
        const PassingPair::Event event = scene.event(seed);
        const ImpactResult exact = query.find(event.a.motion(), event.b.motion(), fineSettings);
        if (!exact.impact || exact.impact->time == 0) {
            continue;
        }
        ++hits;
        for (const int i : {0, 1}) {
            const std::uint64_t work = exact.work / (i == 0 ? 10 : 4);
            const ImpactResult result = query.find(event.a.motion(), event.b.motion(), fineSettings, {.work = work});
            found[i] += result.impact ? 1 : 0;
        }
    }
    EXPECT_GT(hits, 20);
    EXPECT_GE(10 * found[0], 8 * hits);
    EXPECT_GE(20 * found[1], 19 * hits);
}

TEST(ImpactBudget, UnitByUnitFreeUntilNeverFalls) {
    // Fitted balls and a thin box: the balls around its triangles reach out of those of its leaves.
    const scenes::Mesh meshA = scenes::normalised(scenes::bumpySphere(1, 0.3F, 7, 4, 3), 1);
    const scenes::Mesh meshB = scenes::box({0.5F, 0.02F, 0.02F}, 1);
    const BallTree a = buildBallTree(meshA.view());
    const BallTree b = buildBallTree(meshB.view());
    ImpactQuery query(a, b);
    ImpactSettings settings = fineSettings;
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

TEST(ImpactBudget, InPartsTheBudgetIsUsedUpAndTheTimeIsHeld) {
    const PassingPair scene;
    int inBetween = 0;
    int inTheLast = 0;
    int early = 0;
    int settled = 0;
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        const PassingPair::Event event = scene.event(seed);
        SurfaceMotion a = event.a.motion();
        SurfaceMotion b = event.b.motion();
        a.frame.turn = {0.6F, 0, 0.1F};
        b.frame.turn = {0, 1.1F, 0.05F};  // five parts
        ImpactQuery query(scene.a, scene.b);
        const ImpactResult exact = query.find(a, b, fineSettings);
        ASSERT_TRUE(exact.certain);
        const float first = exact.impact ? exact.impact->time : 1;
        float before = 0;
        for (const std::uint64_t work : {20U, 60U, 200U, 500U, 1000U, 2000U, 20'000U}) {
            ImpactSettings settings = fineSettings;
            settings.auditShare = 0;
            const ImpactResult plain = query.find(a, b, settings, {.work = work});
            EXPECT_GE(plain.freeUntil, before);
            before = plain.freeUntil;
            const ImpactResult result = query.find(a, b, fineSettings, {.work = work});
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
    EXPECT_GT(inTheLast, 2);
    EXPECT_GT(early, 3);
    EXPECT_GT(settled, 30);
}

TEST(ImpactBudget, WithoutBudgetNothingIsKnown) {
    const PassingPair scene;
    const PassingPair::Event event = scene.event(1);
    const ImpactResult result =
        ImpactQuery(scene.a, scene.b).find(event.a.motion(), event.b.motion(), fineSettings, {.work = 0});
    EXPECT_EQ(result.work, 0U);
    EXPECT_FALSE(result.impact);
    EXPECT_FALSE(result.certain);
    EXPECT_EQ(result.freeUntil, 0);
    EXPECT_EQ(result.stop, StopReason::budget);
    EXPECT_EQ(result.miss.missedBound, 1);  // the pair of both roots
}

/// How many of the pairs that wait have an impact before the limit?
std::uint64_t trueHits(const PassingPair& scene, const std::vector<TriangleImpact>& impacts,
                       const detail::ImpactFront& front, double limit) {
    std::vector<TriangleImpact> early = impacts;
    std::erase_if(early, [&](const TriangleImpact& impact) { return !(impact.time < limit); });
    return waitingWith(early, scene.a, scene.b, front);
}

TEST(ImpactBudget, TheBoundOnWhatWasMissedHolds) {
    const PassingPair scene(4);
    detail::MovingTree a(scene.a);
    detail::MovingTree b(scene.b);
    std::uint64_t judged = 0;
    std::uint64_t failed = 0;
    double missed = 0;
    double estimated = 0;
    constexpr std::uint64_t events = 8;
    std::vector<PassingPair::Event> event;
    std::vector<std::vector<TriangleImpact>> impacts;
    for (std::uint64_t seed = 0; event.size() < events; ++seed) {
        const PassingPair::Event next = scene.event(seed);
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

}  // namespace
}  // namespace grapeshot::test
