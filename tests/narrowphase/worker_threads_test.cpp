#include <grapeshot/narrowphase/worker_threads.hpp>

#include <gtest/gtest.h>

#include <atomic>
#include <cfenv>
#include <chrono>
#include <mutex>
#include <set>
#include <thread>
#include <vector>

namespace grapeshot {
namespace {

TEST(WorkerThreads, EachPieceIsDoneOnce) {
    for (const int threads : {-1, 0, 1, 2, 4}) {
        for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{7}, std::size_t{1000}}) {
            std::vector<std::atomic<int>> done(count);
            forEach(count, threads, [&](std::size_t i) { ++done[i]; });
            for (const auto& times : done) {
                EXPECT_EQ(times, 1);
            }
        }
    }
}

TEST(WorkerThreads, OneThreadGoesInOrder) {
    std::vector<std::size_t> order;
    forEach(100, 1, [&](std::size_t i) { order.push_back(i); });
    for (std::size_t i = 0; i < 100; ++i) {
        EXPECT_EQ(order[i], i);
    }
}

TEST(WorkerThreads, NoMoreThreadsThanAskedForAndAllRoundTheSameWay) {
    std::mutex mutex;
    std::set<std::thread::id> ids;
    std::set<int> modes;
    std::fesetround(FE_UPWARD);
    const bool several = std::thread::hardware_concurrency() > 1;
    std::atomic<int> arrived{0};
    forEach(2000, 2, [&](std::size_t) {
        // The first two wait for each other, so that both threads have a part. (Not for ever: only one may be free.)
        if (++arrived <= 2) {
            for (int i = 0; several && arrived < 2 && i < 5000; ++i) {
                std::this_thread::sleep_for(std::chrono::milliseconds(1));
            }
        }
        const std::lock_guard lock(mutex);
        ids.insert(std::this_thread::get_id());
        modes.insert(std::fegetround());
    });
    std::fesetround(FE_TONEAREST);
    EXPECT_EQ(ids.size(), several ? 2U : 1U);
    EXPECT_EQ(modes, std::set<int>{FE_UPWARD});
}

}  // namespace
}  // namespace grapeshot
