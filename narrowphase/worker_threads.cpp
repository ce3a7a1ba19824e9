#include <grapeshot/narrowphase/worker_threads.hpp>

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <memory>

namespace grapeshot {
namespace {

/// This thread's, as long as it asks for the same number of threads.
tbb::task_arena& arenaOf(int threads) {
    thread_local std::unique_ptr<tbb::task_arena> arena;
    if (arena == nullptr || arena->max_concurrency() != threads) {
        arena = std::make_unique<tbb::task_arena>(threads);
    }
    return *arena;
}

}  // namespace

void forEach(std::size_t count, int threads, const std::function<void(std::size_t)>& work) {
    if (threads <= 1 || count <= 1) {
        for (std::size_t i = 0; i < count; ++i) {
            work(i);
        }
        return;
    }
    using Context = tbb::task_group_context;
    // The rounding of this thread: not that of when its arena was made.
    Context context(Context::isolated, Context::default_traits | Context::fp_settings);
    // Beyond it there is nothing to gain, and oneTBB says so on stderr.
    arenaOf(std::min(threads, tbb::info::default_concurrency())).execute([&] {
        tbb::parallel_for(
            tbb::blocked_range<std::size_t>(0, count, 1),
            [&work](const tbb::blocked_range<std::size_t>& range) {
                for (std::size_t i = range.begin(); i != range.end(); ++i) {
                    work(i);
                }
            },
            tbb::simple_partitioner(), context);
    });
}

}  // namespace grapeshot
