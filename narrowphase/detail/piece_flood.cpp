#include <grapeshot/narrowphase/detail/piece_flood.hpp>

#include <algorithm>

#include <grapeshot/core/detail/wide_targets.hpp>
#undef HWY_TARGET_INCLUDE
// NOLINTNEXTLINE(bugprone-macro-parentheses)
#define HWY_TARGET_INCLUDE <grapeshot/narrowphase/detail/piece_flood.cpp>
#include <hwy/foreach_target.h>

#include <grapeshot/core/detail/wide.hpp>

HWY_BEFORE_NAMESPACE();
namespace grapeshot::detail::HWY_NAMESPACE {

HWY_INLINE Float16 squaredDistance(const float* x, std::size_t stride, const float (&p)[3]) {
    const Float16 dx = load(x) - wide(p[0]);
    const Float16 dy = load(x + stride) - wide(p[1]);
    const Float16 dz = load(x + 2 * stride) - wide(p[2]);
    return dx * dx + dy * dy + dz * dz;
}

/// What a search is about to join.
struct Search {
    const FloodPieces::View* view;
    float spacing;
    const float* axis;
    float cone;
    std::uint32_t* found;
    std::size_t count;
};

/// Joins those of a block that are within `reach` (m) and their own radius of p.
HWY_INLINE void joinBlock(Search& search, std::size_t block, const float (&p)[3], float reach) {
    const std::size_t stride = search.view->stride;
    const float* const first = search.view->columns + 16 * block;
    const std::uint32_t candidates = search.view->candidates[block];
    const Float16 limit = load(first + 6 * stride) + wide(reach);
    std::uint32_t joined = candidates & bits(squaredDistance(first, stride, p) <= limit * limit);
    if (search.axis != nullptr) {
        joined &=
            bits(load(first + 3 * stride) * wide(search.axis[0]) + load(first + 4 * stride) * wide(search.axis[1]) +
                     load(first + 5 * stride) * wide(search.axis[2]) >=
                 wide(search.cone));
    }
    search.view->candidates[block] = candidates & ~joined;
    for (; joined != 0; joined &= joined - 1) {
        search.found[search.count++] =
            static_cast<std::uint32_t>(16 * block) + static_cast<std::uint32_t>(__builtin_ctz(joined));
    }
}

/// The neighbours of one piece.
HWY_INLINE void join(Search& search, std::uint32_t piece) {
    const FloodPieces::View& view = *search.view;
    const float p[3] = {view.columns[piece], view.columns[view.stride + piece], view.columns[2 * view.stride + piece]};
    const float reach = search.spacing + view.columns[6 * view.stride + piece];
    if (view.blockCount <= FloodPieces::fewBlocks) {
        for (std::size_t block = 0; block < view.blockCount; ++block) {
            if (view.candidates[block] != 0) {
                joinBlock(search, block, p, reach);
            }
        }
        return;
    }
    for (std::size_t sixteen = 0; sixteen < view.blockCount; sixteen += 16) {
        const float* const middles = view.blocks + sixteen;
        const Float16 limit = load(middles + 3 * view.blockStride) + wide(reach);
        std::uint32_t near = bits(squaredDistance(middles, view.blockStride, p) <= limit * limit);
        for (; near != 0; near &= near - 1) {
            const std::size_t block = sixteen + static_cast<std::size_t>(__builtin_ctz(near));
            if (view.candidates[block] != 0) {
                joinBlock(search, block, p, reach);
            }
        }
    }
}

std::size_t floodFrom(const FloodPieces::View& view, std::uint32_t seed, float spacing, const float* axis, float cone,
                      std::uint32_t* found) {
    view.candidates[seed / 16] &= ~(1U << (seed % 16));
    found[0] = seed;
    Search search{&view, spacing, axis, cone, found, 1};
    std::uint32_t rest = 0;
    for (std::size_t block = 0; block < view.blockCount; ++block) {
        rest += static_cast<std::uint32_t>(__builtin_popcount(view.candidates[block]));
    }
    for (std::size_t next = 0; next < search.count && search.count <= rest; ++next) {
        join(search, found[next]);
    }
    return search.count;
}

}  // namespace grapeshot::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <grapeshot/core/detail/kernel_table.hpp>

namespace grapeshot::detail {

namespace {

constexpr std::size_t columnsOfPiece = 7;
constexpr std::size_t columnsOfBlock = 4;

}  // namespace

void FloodPieces::reset(std::size_t most) {
    m_count = 0;
    m_stride = (most + 15) / 16 * 16;
    m_columns.resize(std::max(m_columns.size(), columnsOfPiece * std::max<std::size_t>(m_stride, 16) / 16));
}

void FloodPieces::finish() {
    const std::size_t blocks = (m_count + 15) / 16;
    // Where there is no block there are no candidates: a reach beyond all measure finds those places too.
    m_candidates.assign((blocks + 15) / 16 * 16, 0);
    std::fill_n(m_candidates.begin(), blocks, 0xffffU);
    if (m_count % 16 != 0) {
        m_candidates[blocks - 1] = (1U << (m_count % 16)) - 1;
    }
    if (blocks <= fewBlocks) {
        return;
    }
    m_blockStride = (blocks + 15) / 16 * 16;
    m_blocks.resize(std::max(m_blocks.size(), columnsOfBlock * m_blockStride / 16));
    float* const out = m_blocks.data()->lane;
    for (std::size_t block = 0; block < m_blockStride; ++block) {
        const std::size_t begin = std::min(16 * block, m_count);
        const std::size_t end = std::min(begin + 16, m_count);
        constexpr float farAway = 1e18F;  // where an empty block is
        Eigen::Vector3f middle = Eigen::Vector3f::Constant(begin < end ? 0 : farAway);
        for (std::size_t i = begin; i < end; ++i) {
            middle += position(i) / static_cast<float>(end - begin);
        }
        float radius = 0;
        for (std::size_t i = begin; i < end; ++i) {
            radius =
                std::max(radius, 1.00001F * (position(i) - middle).norm() + m_columns.data()->lane[6 * m_stride + i]);
        }
        for (std::size_t axis = 0; axis < 3; ++axis) {
            out[axis * m_blockStride + block] = middle[static_cast<int>(axis)];
        }
        out[3 * m_blockStride + block] = radius;
    }
}

void FloodPieces::flood(std::uint32_t seed, float spacing, const Eigen::Vector3f* axis, float cone,
                        std::vector<std::uint32_t>& found) {
    static constexpr auto kernel = GRAPESHOT_KERNEL_TABLE(floodFrom);
    found.resize(m_count);
    const View view{
        m_columns.data()->lane, m_stride,           m_blocks.empty() ? nullptr : m_blocks.data()->lane, m_blockStride,
        (m_count + 15) / 16,    m_candidates.data()};
    found.resize(kernel.chosen()(view, seed, spacing, axis != nullptr ? axis->data() : nullptr, cone, found.data()));
}

}  // namespace grapeshot::detail
#endif
