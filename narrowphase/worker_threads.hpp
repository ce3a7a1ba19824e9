// Many independent pieces of work on several threads.
#pragma once

#include <cstddef>
#include <functional>

namespace grapeshot {

/// Calls work(i) once for each i below `count`, on up to `threads` threads (this one among them), in any order; returns
/// when all are done. With one thread: in order, on this thread. Rounding modes are this thread's. `work` must not
/// throw.
void forEach(std::size_t count, int threads, const std::function<void(std::size_t)>& work);

}  // namespace grapeshot
