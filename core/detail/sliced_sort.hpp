// A sort in slices: runs, then merges. O(n log n).
#pragma once

#include <algorithm>
#include <vector>

#include <grapeshot/core/sliced.hpp>

namespace grapeshot::detail {

/// Sorts items[begin, end), no two of which may be equal to `less`. `spare` is overwritten: memory, as much again.
template <class T, class Less>
Sliced sortSliced(std::vector<T>& items, std::size_t begin, std::size_t end, std::vector<T>& spare, Less less) {
    constexpr std::size_t run = 64;
    constexpr std::size_t piece = 512;
    for (std::size_t i = begin; i < end; i += run) {
        co_yield 4;
        std::sort(items.begin() + std::ptrdiff_t(i), items.begin() + std::ptrdiff_t(std::min(i + run, end)), less);
    }
    const std::size_t size = end - begin;
    if (size <= run) {
        co_return;
    }
    spare.clear();
    spare.reserve(size);
    for (std::size_t i = begin; i < end; i += piece) {
        co_yield 4;
        spare.insert(spare.end(), items.begin() + std::ptrdiff_t(i),
                     items.begin() + std::ptrdiff_t(std::min(i + piece, end)));
    }
    T* from = spare.data();
    T* to = items.data() + begin;
    for (std::size_t width = run; width < size; width *= 2) {
        for (std::size_t low = 0; low < size; low += 2 * width) {
            std::size_t left = low;
            const std::size_t middle = std::min(low + width, size);
            std::size_t right = middle;
            const std::size_t high = std::min(low + 2 * width, size);
            for (std::size_t at = low; at < high;) {
                const std::size_t pause = std::min(at + piece, high);
                co_yield (pause - at + 63) / 64;
                for (; at < pause; ++at) {
                    const bool takesRight = left == middle || (right < high && less(from[right], from[left]));
                    to[at] = from[takesRight ? right++ : left++];
                }
            }
        }
        std::swap(from, to);
    }
    if (from != items.data() + begin) {
        for (std::size_t i = 0; i < size; i += piece) {
            co_yield 4;
            std::copy(from + i, from + std::min(i + piece, size), items.data() + begin + i);
        }
    }
}

}  // namespace grapeshot::detail
