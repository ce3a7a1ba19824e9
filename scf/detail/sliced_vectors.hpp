// Long vectors filled and copied in slices, see core/sliced.hpp.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <grapeshot/core/sliced.hpp>

namespace grapeshot::detail {

inline constexpr std::size_t itemsPerUnit = 256;  ///< of some bytes each, memory met for the first time

template <class T>
Sliced fillInSlices(std::vector<T>& items, std::size_t size, T value) {
    items.clear();
    items.reserve(size);
    const auto grow = [&](std::size_t, std::size_t end) { items.resize(end, value); };
    co_await inPieces(0, size, itemsPerUnit, grow);
}

template <class T>
Sliced copyInSlices(std::span<const T> from, std::vector<T>& to) {
    to.clear();
    to.reserve(from.size());
    const auto append = [&](std::size_t begin, std::size_t end) {
        to.insert(to.end(), from.begin() + static_cast<std::ptrdiff_t>(begin),
                  from.begin() + static_cast<std::ptrdiff_t>(end));
    };
    co_await inPieces(0, from.size(), itemsPerUnit, append);
}

}  // namespace grapeshot::detail
