// Work in slices, to its end.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>

#include <grapeshot/core/sliced.hpp>

namespace grapeshot::test {

/// No slice is exceeded, and each gets on. Returns the sum of the units.
inline std::uint64_t inSlices(Sliced& work, std::uint64_t slice) {
    std::uint64_t sum = 0;
    while (!work.isDone()) {
        const std::uint64_t done = work.run({.work = slice});
        EXPECT_LE(done, slice);
        EXPECT_TRUE(done > 0 || work.isDone());
        sum += done;
    }
    return sum;
}
inline std::uint64_t inSlices(Sliced&& work, std::uint64_t slice) {
    return inSlices(work, slice);
}

}  // namespace grapeshot::test
