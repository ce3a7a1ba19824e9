// How the work of the parallel phase splits over threads: by counts of work, so that it holds on any machine.
#include <gtest/gtest.h>

#include <algorithm>

#include "bullet_fixture.hpp"

namespace grapeshot::test {
namespace {

/// Units until the last of so many threads is done, if each takes the next pair as soon as it is free.
std::uint64_t makespan(const std::vector<std::uint64_t>& works, std::size_t threads) {
    std::vector<std::uint64_t> busy(threads, 0);
    for (const std::uint64_t work : works) {
        *std::ranges::min_element(busy) += work;
    }
    return *std::ranges::max_element(busy);
}

/// Of the mesh pairs of the last step, as they are handed out: by ascending ids.
std::vector<std::uint64_t> worksOf(const StepStatistics& step) {
    std::vector<PairStatistics> pairs = step.pairs;
    std::ranges::sort(pairs, [](const PairStatistics& x, const PairStatistics& y) {
        return std::pair(x.proxyA, x.proxyB) < std::pair(y.proxyA, y.proxyB);
    });
    std::vector<std::uint64_t> works;
    for (const PairStatistics& pair : pairs) {
        works.push_back(pair.work);
    }
    return works;
}

TEST(ParallelSplit, TwoThreadsHaveHalfTheWorkEach) {
    const MeshShape ball(scenes::bumpySphere(0.4F, 0.08F, 5, 12), Kind::mesh, 0.02_s);
    const MeshShape torus(scenes::torus(0.4F, 0.15F, 48, 24), Kind::bvh, 0.02_s);
    const MeshShape floor(scenes::grid(4, 4, 20, 20), Kind::bvh, 0.02_s);
    for (const std::uint64_t budget : {unlimited, std::uint64_t(1500)}) {
        Settings settings;
        settings.frameBudget.work = budget;
        BudgetWorld world(settings);
        world.add(*floor, at({0, 0, 0}));
        for (int i = 0; i < 36; ++i) {
            btRigidBody& body =
                world.add(i % 2 == 0 ? *ball : *torus,
                          at({0.7_s * btScalar(i % 3), 0.6_s + 0.75_s * btScalar(i / 9), 0.7_s * btScalar(i / 3 % 3)},
                             btQuaternion({1, 0.3_s, 0.1_s}, btScalar(i))),
                          1);
            body.setActivationState(DISABLE_DEACTIVATION);
        }
        std::uint64_t whole = 0;
        std::uint64_t two = 0;
        std::uint64_t four = 0;
        for (int i = 0; i < 120; ++i) {
            world.step();
            const std::vector<std::uint64_t> works = worksOf(world.stats());
            whole += makespan(works, 1);
            two += makespan(works, 2);
            four += makespan(works, 4);
        }
        EXPECT_GT(whole, 20000U);
        EXPECT_GE(static_cast<double>(whole), 1.8 * static_cast<double>(two)) << budget;
        EXPECT_GE(static_cast<double>(whole), 3 * static_cast<double>(four)) << budget;
        RecordProperty("of_two", std::to_string(static_cast<double>(whole) / static_cast<double>(two)));
        RecordProperty("of_four", std::to_string(static_cast<double>(whole) / static_cast<double>(four)));
    }
}

}  // namespace
}  // namespace grapeshot::test
