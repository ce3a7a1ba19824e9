#include <grapeshot/scf/close_leaves.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <tuple>

#include <grapeshot/scf/detail/meter.hpp>
#include <grapeshot/scf/detail/pair_space.hpp>
#include <grapeshot/scf/detail/placing.hpp>

namespace grapeshot {

using detail::BallPair;
using detail::PosedTree;

namespace {

struct Item {
    float priority = 0;
    BallPair pair;
};

bool isLater(const Item& x, const Item& y) {
    return std::tuple(x.priority, x.pair.a, x.pair.b) < std::tuple(y.priority, y.pair.a, y.pair.b);
}

}  // namespace

struct CloseLeafSearch::Workspace {
    std::optional<PosedTree> a, b;
    std::vector<Item> heap;
};

CloseLeafSearch::CloseLeafSearch() : m_workspace(std::make_unique<Workspace>()) {}
CloseLeafSearch::~CloseLeafSearch() = default;

namespace {

constexpr std::uint64_t mostOfTwoLeaves = 17;  // units
constexpr float byChance = 0.9F;               // share of the priority

/// False: the state cannot be used.
bool place(std::optional<PosedTree>& posed, const BallTree& tree, const SurfaceState& state) {
    if (detail::faultIn(state, tree.surface)) {
        return false;
    }
    posed ? posed->turnTo(tree) : void(posed.emplace(tree));
    return !detail::place(state, *posed).fault;
}

}  // namespace

CloseLeafResult CloseLeafSearch::find(const BallTree& a, const SurfaceState& stateA, const BallTree& b,
                                      const SurfaceState& stateB, float maxDistance, const Budget& budget,
                                      const RandomKey& order, std::vector<CloseLeaves>& out) {
    out.clear();
    CloseLeafResult result;
    Workspace& w = *m_workspace;
    if (!(maxDistance >= 0 && std::isfinite(maxDistance)) || !place(w.a, a, stateA) || !place(w.b, b, stateB)) {
        return result;
    }
    const detail::PairSpace space{&*w.a, &*w.b, maxDistance, -1};
    detail::Meter meter(budget);
    // Without a budget the order is nobody's business, and a stack is cheaper.
    const bool ordered = !meter.isUnlimited();
    std::uint32_t draw = 0;
    w.heap.assign(1, {1, {0, 0}});
    detail::ChildPairs children;
    float weight[16];
    while (!w.heap.empty()) {
        const Item item = ordered ? w.heap.front() : w.heap.back();
        const bool leaves = isBallLeaf(item.pair.a) && isBallLeaf(item.pair.b);
        if (meter.left(result.work) < (leaves ? mostOfTwoLeaves : 1)) {
            break;
        }
        if (ordered) {
            std::pop_heap(w.heap.begin(), w.heap.end(), isLater);
        }
        w.heap.pop_back();
        if (leaves) {
            CloseLeaves close{ballIndex(item.pair.a), ballIndex(item.pair.b), {}};
            result.work +=
                detail::closeRows(w.a->leaf(close.leafA), w.b->leaf(close.leafB), maxDistance, -1, close.row);
            std::uint32_t any = 0;
            for (const std::uint16_t row : close.row) {
                any |= row;
            }
            if (any != 0) {
                out.push_back(close);
            }
            continue;
        }
        result.work += space.expand(item.pair, children, ordered ? &weight : nullptr);
        for (std::uint32_t left = children.mask; left != 0U; left &= left - 1U) {
            const auto lane = static_cast<unsigned>(std::countr_zero(left));
            Item next{0, children.at(lane)};
            if (ordered) {
                next.priority = weight[lane] * (1 - byChance + byChance * randomUnit(order, draw++));
                w.heap.push_back(next);
                std::push_heap(w.heap.begin(), w.heap.end(), isLater);
            } else {
                w.heap.push_back(next);
            }
        }
    }
    result.complete = w.heap.empty() && w.a->isFinite() && w.b->isFinite();
    return result;
}

}  // namespace grapeshot
