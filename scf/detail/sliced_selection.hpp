// The smaller ones first, in slices. O(n) on average.
//
// This work is based on:
// Charles Hoare. Algorithm 65: find. Communications of the ACM 4, 1961
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <grapeshot/core/sliced.hpp>

namespace grapeshot::detail {

/// As std::nth_element on [begin, end): items[middle] is the one that would stand there if they were sorted, nothing
/// before it is larger, nothing after it smaller. No two may be equal to `less`.
template <class T, class Less>
Sliced selectSliced(std::vector<T>& items, std::size_t begin, std::size_t middle, std::size_t end, Less less) {
    constexpr std::size_t few = 64;
    constexpr std::size_t perUnit = 24;
    std::uint64_t chance = 0x9e3779b97f4a7c15ULL;  // so that no order of the items is a bad one by itself
    const auto at = [&](std::size_t i) { return items.begin() + static_cast<std::ptrdiff_t>(i); };
    while (end - begin > few) {
        std::size_t draw[3];
        for (std::size_t& one : draw) {
            chance = chance * 6364136223846793005ULL + 1442695040888963407ULL;
            one = begin + static_cast<std::size_t>((chance >> 33U) % (end - begin));
        }
        std::sort(draw, draw + 3, [&](std::size_t a, std::size_t b) { return a != b && less(items[a], items[b]); });
        std::swap(items[draw[1]], items[end - 1]);
        const T pivot = items[end - 1];
        std::size_t smaller = begin;
        const auto part = [&](std::size_t from, std::size_t to) {
            for (std::size_t i = from; i < to; ++i) {
                if (less(items[i], pivot)) {
                    std::swap(items[i], items[smaller++]);
                }
            }
        };
        co_await inPieces(begin, end - 1, perUnit, part);
        std::swap(items[smaller], items[end - 1]);
        if (smaller == middle) {
            co_return;
        }
        (smaller < middle ? begin : end) = smaller < middle ? smaller + 1 : smaller;
    }
    if (middle < end) {
        co_yield (end - begin + 15) / 16;
        std::nth_element(at(begin), at(middle), at(end), less);
    }
}

}  // namespace grapeshot::detail
