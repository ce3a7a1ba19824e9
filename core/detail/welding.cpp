#include <grapeshot/core/detail/welding.hpp>

#include <bit>

namespace grapeshot::detail {
namespace {

std::uint64_t hashOf(const Eigen::Vector3f& p) {
    std::uint64_t hash = 0x9e3779b97f4a7c15U;
    for (int axis = 0; axis < 3; ++axis) {
        const float value = p[axis] == 0 ? 0.0F : p[axis];  // one zero
        hash = (hash ^ std::bit_cast<std::uint32_t>(value)) * 0xff51afd7ed558ccdU;
        hash ^= hash >> 32U;
    }
    return hash;
}

}  // namespace

Sliced weldInSlices(std::span<const Eigen::Vector3f> vertices, std::vector<std::uint32_t>& welded) {
    constexpr std::uint32_t empty = 0xffffffffU;
    const std::size_t size = std::bit_ceil(2 * vertices.size() + 1);
    std::vector<std::uint32_t> table;
    table.reserve(size);
    const auto clear = [&](std::size_t, std::size_t end) { table.resize(end, empty); };
    co_await inPieces(0, size, 1024, clear);
    welded.clear();
    welded.reserve(vertices.size());
    const auto insert = [&](std::size_t begin, std::size_t end) {
        for (auto v = static_cast<std::uint32_t>(begin); v < end; ++v) {
            welded.push_back(v);
            if (!vertices[v].allFinite()) {
                continue;
            }
            for (std::size_t slot = hashOf(vertices[v]) & (size - 1);; slot = (slot + 1) & (size - 1)) {
                if (table[slot] == empty) {
                    table[slot] = v;
                    break;
                }
                if (vertices[table[slot]] == vertices[v]) {
                    welded[v] = table[slot];
                    break;
                }
            }
        }
    };
    co_await inPieces(0, vertices.size(), 6, insert);
}

}  // namespace grapeshot::detail
