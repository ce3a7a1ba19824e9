#include <grapeshot/adb/near_leaves.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include <grapeshot/adb/detail/leaf_descent.hpp>
#include <grapeshot/adb/detail/stack_storage.hpp>

namespace grapeshot {

using detail::PoseVerdict;

struct NearLeafSearch::State {
    detail::Descent descent;
    detail::StackStorage storage;
    detail::LeafPairBatch batch;
    detail::PassedBy passed;
};

NearLeafSearch::NearLeafSearch() : m_state(std::make_unique<State>()) {}
NearLeafSearch::~NearLeafSearch() = default;

bool NearLeafSearch::find(const Tree& a, const Tree& b, const Pose& bInA, float maxDistance, float reach,
                          NearLeaves& out) {
    constexpr float infinity = std::numeric_limits<float>::infinity();
    out.pairs.clear();
    out.work = 0;
    for (int side = 0; side < 2; ++side) {
        out.lower[side].setConstant(infinity);
        out.upper[side].setConstant(-infinity);
    }
    if (!(maxDistance >= 0 && reach >= maxDistance)) {
        return false;
    }
    detail::Descent& descent = m_state->descent;
    detail::PassedBy& passed = m_state->passed;
    const PoseVerdict far = detail::prepare(bInA, a.radius, b.radius, reach, descent.prepared);
    if (far == PoseVerdict::invalid) {
        return false;
    }
    if (far == PoseVerdict::apart || a.nodes.empty() || b.nodes.empty()) {
        return true;
    }
    passed.threshold = descent.prepared.threshold;
    if (detail::prepare(bInA, a.radius, b.radius, maxDistance, descent.prepared) != PoseVerdict::usable) {
        out.lower[0] = a.lower, out.upper[0] = a.upper;
        out.lower[1] = b.lower, out.upper[1] = b.upper;
        return true;
    }
    for (int side = 0; side < 2; ++side) {
        for (int axis = 0; axis < 3; ++axis) {
            std::fill(std::begin(passed.lower[side][axis]), std::end(passed.lower[side][axis]), infinity);
            std::fill(std::begin(passed.upper[side][axis]), std::end(passed.upper[side][axis]), -infinity);
        }
    }
    m_state->storage.lendTo(descent);
    descent.pose = bInA;
    descent.depth = 0;
    descent.work = 0;
    detail::setTrees(descent, a, b);
    detail::push(descent, detail::sidePair(0, 0));
    detail::LeafPairBatch& batch = m_state->batch;
    for (bool more = true; more;) {
        more = detail::toLeafPairs(descent, batch, passed) == detail::DescentEnd::found;
        for (std::size_t i = 0; i < batch.count; ++i) {
            out.pairs.push_back({batch.leafA[i], batch.leafB[i]});
        }
    }
    out.work = descent.work;
    for (int side = 0; side < 2; ++side) {
        for (int axis = 0; axis < 3; ++axis) {
            const auto& lower = passed.lower[side][axis];
            const auto& upper = passed.upper[side][axis];
            out.lower[side][axis] = *std::min_element(std::begin(lower), std::end(lower));
            out.upper[side][axis] = *std::max_element(std::begin(upper), std::end(upper));
        }
    }
    return true;
}

}  // namespace grapeshot
