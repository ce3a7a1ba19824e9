// Are two arrays the same to the last bit?
#pragma once

#include <cstring>
#include <vector>

namespace grapeshot::test {

template <typename T>
bool sameBytes(const std::vector<T>& a, const std::vector<T>& b) {
    return a.size() == b.size() && std::memcmp(static_cast<const void*>(a.data()), static_cast<const void*>(b.data()),
                                               a.size() * sizeof(T)) == 0;
}

}  // namespace grapeshot::test
