#include <grapeshot/scf/close_leaves.hpp>

#include <bit>
#include <cmath>
#include <optional>

#include <grapeshot/scf/detail/meter.hpp>
#include <grapeshot/scf/detail/pair_space.hpp>
#include <grapeshot/scf/detail/placing.hpp>

namespace grapeshot {

using detail::BallPair;
using detail::PosedTree;

struct CloseLeafSearch::Workspace {
    std::optional<PosedTree> a, b;
    std::vector<BallPair> stack;
};

CloseLeafSearch::CloseLeafSearch() : m_workspace(std::make_unique<Workspace>()) {}
CloseLeafSearch::~CloseLeafSearch() = default;

namespace {

constexpr std::uint64_t mostOfTwoLeaves = 17;  // units

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
                                      std::vector<CloseLeaves>& out) {
    out.clear();
    CloseLeafResult result;
    Workspace& w = *m_workspace;
    if (!(maxDistance >= 0 && std::isfinite(maxDistance)) || !place(w.a, a, stateA) || !place(w.b, b, stateB)) {
        return result;
    }
    const detail::PairSpace space{&*w.a, &*w.b, maxDistance, -1};
    detail::Meter meter(budget);
    w.stack.assign(1, {0, 0});
    detail::ChildPairs children;
    while (!w.stack.empty()) {
        const BallPair pair = w.stack.back();
        const bool leaves = isBallLeaf(pair.a) && isBallLeaf(pair.b);
        if (meter.left(result.work) < (leaves ? mostOfTwoLeaves : 1)) {
            break;
        }
        w.stack.pop_back();
        if (leaves) {
            CloseLeaves close{ballIndex(pair.a), ballIndex(pair.b), {}};
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
        result.work += space.expand(pair, children, nullptr);
        for (std::uint32_t left = children.mask; left != 0U; left &= left - 1U) {
            w.stack.push_back(children.at(static_cast<unsigned>(std::countr_zero(left))));
        }
    }
    result.complete = w.stack.empty() && w.a->isFinite() && w.b->isFinite();
    return result;
}

}  // namespace grapeshot
