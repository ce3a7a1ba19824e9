#include <grapeshot/narrowphase/solid_update.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

#include <grapeshot/narrowphase/detail/pair_search.hpp>
#include <grapeshot/narrowphase/relative_motion.hpp>
#include <grapeshot/narrowphase/stand_in.hpp>

namespace grapeshot {
namespace {

/// What limits of time are taken for, per work unit.
constexpr std::int64_t unitNanoseconds = 200;

struct Scratch {
    std::vector<SearchRegion> regions;
    std::vector<std::uint32_t> leaves;
    std::vector<SurfaceContact> found;
    detail::PairSearch witnesses;
};

Scratch& threadScratch() {
    thread_local Scratch scratch;
    return scratch;
}

bool isFarther(const OpenChild& left, const OpenChild& right) {
    return left.distance != right.distance ? left.distance > right.distance : left.child > right.child;
}

/// A search within a budget, as far as it goes in one call.
class SolidSearch {
  public:
    SolidSearch(const MeshModel& mesh, const Solid& solid, const LocalContactSettings& settings, Purse& purse,
                PairState& state, Scratch& scratch)
        : m_mesh(mesh), m_solid(solid), m_settings(settings), m_purse(purse), m_state(state), m_scratch(scratch) {
        scratch.regions.clear();
        scratch.leaves.clear();
        // Not more than a quarter, or nothing would be left to look into.
        m_reserve = std::min(solid.regions(mesh, settings.maxDistance, scratch.regions), units() / 4);
    }

    /// Returns whether nothing is missing.
    bool run(const Pose& pose, float slack) {
        takeWitnesses();
        m_witnesses = m_scratch.leaves.size();
        const bool listed = m_state.candidateDistance >= m_settings.maxDistance &&
                            boxMotionBound(m_mesh.tree, m_state.candidatePose, pose) <=
                                m_state.candidateDistance - m_settings.maxDistance;
        const bool goesOn = !m_state.openChildren.empty() && m_state.traversalDistance >= m_settings.maxDistance &&
                            boxMotionBound(m_mesh.tree, m_state.candidatePose, pose) <=
                                m_state.traversalDistance - m_settings.maxDistance;
        if (!listed && !goesOn) {
            begin(pose, slack);
        }
        m_traversed = !listed;
        const bool all = searchInTurns();
        return test(all);
    }

    [[nodiscard]] bool hasTraversed() const { return m_traversed; }

  private:
    /// Work units that are left, by the clock too.
    [[nodiscard]] std::uint64_t units() const {
        const Budget left = m_purse.left();
        const auto byTime = static_cast<std::uint64_t>(left.time.count() / unitNanoseconds);
        return left.time == never ? left.work : std::min(left.work, byTime);
    }

    /// A leaf is taken if it can still be paid for; a region that it touches is paid for once.
    bool take(std::uint32_t leaf) {
        const auto known = m_scratch.leaves.begin() + static_cast<std::ptrdiff_t>(m_witnesses);
        if (std::find(m_scratch.leaves.begin(), known, leaf) != known) {
            return true;
        }
        const LeafShape& shape = m_mesh.leafShapes[leaf];
        const auto touched = std::count_if(m_scratch.regions.begin(), m_scratch.regions.end(),
                                           [&](const SearchRegion& region) { return region.touches(shape); });
        if (touched == 0) {
            return true;
        }
        const std::uint64_t quarters = m_quarters + m_solid.leafQuarters() * static_cast<std::uint64_t>(touched);
        if (unitsOf(quarters) > m_available) {
            return false;
        }
        m_quarters = quarters;
        m_scratch.leaves.push_back(leaf);
        return true;
    }

    [[nodiscard]] static std::uint64_t unitsOf(std::uint64_t quarters) { return (quarters + 3) / 4; }

    void takeWitnesses() {
        const std::uint64_t most = units();
        m_available = (most - std::min(most, m_reserve)) / 2;
        detail::findWitnesses(m_mesh, nullptr, m_state.contacts, m_scratch.witnesses);
        for (const LeafPair& pair : m_scratch.witnesses.witnesses) {
            m_witnesses = m_scratch.leaves.size();
            if (!take(pair.leafA)) {
                break;
            }
        }
        m_available = most - std::min(most, m_reserve);
    }

    void begin(const Pose& pose, float slack) {
        detail::forgetCandidates(m_state);
        m_state.traversalDistance = m_settings.maxDistance + slack;
        m_state.candidatePose = pose;
        if (!m_mesh.tree.nodes.empty()) {
            m_state.openChildren.push_back({-std::numeric_limits<float>::infinity(), 0});
        }
    }

    /// Up to `most` units of the traversal. A leaf is a candidate when nothing nearer is left to look into.
    void goOnTraversing(std::uint64_t most) {
        most = std::min(most, m_available - unitsOf(m_quarters));
        std::uint64_t nodes = 0;
        std::vector<OpenChild>& open = m_state.openChildren;
        while (!open.empty()) {
            const bool leaf = isLeaf(open.front().child);
            if (!leaf && nodes == 4 * most) {
                break;
            }
            std::pop_heap(open.begin(), open.end(), isFarther);
            const OpenChild next = open.back();
            open.pop_back();
            if (leaf) {
                m_state.candidates.push_back({indexOf(next.child), 0});
            } else {
                ++nodes;
                pushChildren(m_mesh.tree.nodes[next.child]);
            }
        }
        const std::uint64_t work = unitsOf(nodes);
        m_purse.pay(work);
        m_available -= work;
        if (open.empty()) {
            m_state.candidateDistance = m_state.traversalDistance;
        }
    }

    void pushChildren(const Node& node) {
        for (int slot = 0; slot < 4; ++slot) {
            if (node.child[slot] == noChild) {
                continue;
            }
            const Eigen::Vector3f center(node.center[0][slot], node.center[1][slot], node.center[2][slot]);
            const Eigen::Vector3f half(node.half[0][slot], node.half[1][slot], node.half[2][slot]);
            const float distance = m_solid.distanceBound(center, half);
            // The bound is rounded.
            const float rounding = 1e-5F * (m_mesh.tree.radius + std::abs(distance));
            if (distance - rounding <= m_state.traversalDistance) {
                m_state.openChildren.push_back({distance, node.child[slot]});
                std::push_heap(m_state.openChildren.begin(), m_state.openChildren.end(), isFarther);
            }
        }
    }

    bool takeUntil(std::size_t end) {
        while (m_state.nextCandidate < end && take(m_state.candidates[m_state.nextCandidate].leafA)) {
            ++m_state.nextCandidate;
        }
        return m_state.nextCandidate == end;
    }

    /// The turns do not depend on the budget: a larger one does what a smaller one does, and more. True if all leaves
    /// are known and taken.
    bool searchInTurns() {
        m_state.nextCandidate = std::min(m_state.nextCandidate, m_state.candidates.size());
        const std::size_t first = m_state.nextCandidate;
        for (std::uint64_t turn = 1;; turn = std::min<std::uint64_t>(2 * turn, 32)) {
            if (!takeUntil(m_state.candidates.size())) {
                return false;
            }
            if (m_state.openChildren.empty()) {
                break;
            }
            if (m_available == unitsOf(m_quarters)) {
                return false;
            }
            goOnTraversing(turn);
        }
        m_state.nextCandidate = 0;
        return takeUntil(first);
    }

    bool test(bool all) {
        std::ranges::sort(m_scratch.leaves);
        const auto repeated = std::ranges::unique(m_scratch.leaves);
        m_scratch.leaves.erase(repeated.begin(), repeated.end());
        m_purse.pay(unitsOf(m_quarters));
        LeafChoice choice{m_scratch.leaves, all, m_purse, m_state.step};
        m_solid.contacts(m_mesh, m_settings.maxDistance, m_settings, m_scratch.found, &choice);
        return all && choice.complete;
    }

    const MeshModel& m_mesh;
    const Solid& m_solid;
    const LocalContactSettings& m_settings;
    Purse& m_purse;
    PairState& m_state;
    Scratch& m_scratch;
    std::uint64_t m_reserve = 0;    // units that are kept for what is not leaf by leaf
    std::uint64_t m_available = 0;  // units for nodes and leaves; of leaves those that are taken are not yet paid for
    std::uint64_t m_quarters = 0;   // of units, for the leaves that are taken
    std::size_t m_witnesses = 0;    // of the leaves that are taken the first so many may come by again
    bool m_traversed = false;
};

bool isUsable(const PairSettings& settings) {
    return std::isfinite(settings.maxDistance) && std::isfinite(settings.slack) && settings.slack >= 0;
}

}  // namespace

PairResult updateSolid(const MeshModel& mesh, const Solid& solid, const Pose& pose, const PairSettings& settings,
                       Budget budget, PairState& state) {
    PairResult result;
    ++state.step;
    if (!isRigid(pose) || !isUsable(settings)) {
        return result;
    }
    Scratch& s = threadScratch();
    s.found.clear();
    Purse purse(budget);
    ContactSetSettings staying = settings.set;
    if (state.cutShort && !purse.isUnlimited()) {
        staying.mergeDistance *= detail::slidingEvidence;
    }
    dropStandIns(state.contacts);
    refresh(state.contacts, pose, staying);
    LocalContactSettings local = settings.local;
    local.maxDistance = settings.maxDistance;
    bool complete = true;
    if (purse.isUnlimited()) {
        detail::forgetCandidates(state);
        purse.pay(solid.contacts(mesh, settings.maxDistance, local, s.found, nullptr));
        result.traversed = true;
    } else {
        const bool slow = state.step <= 1 || boxMotionBound(mesh.tree, state.searchPose, pose) <= settings.slack / 3;
        Budget ofSearch = budget;
        const bool bare = !hasPoints(state.contacts);
        const std::uint64_t reserve = bare ? std::min(solid.standInWork(), budget.work / 2) : 0;
        ofSearch.work -= budget.work != unlimited ? reserve : 0;
        purse = Purse(ofSearch);
        SolidSearch search(mesh, solid, local, purse, state, s);
        complete = search.run(pose, slow ? settings.slack : 0.0F);
        if (!complete && reserve > 0 && s.found.empty()) {
            purse.pay(solid.standIn(mesh, settings.set.regions, settings.maxDistance / 4, reserve, s.found));
        }
        result.traversed = search.hasTraversed();
        result.candidates = static_cast<std::uint32_t>(s.leaves.size());
    }
    merge(state.contacts, s.found, pose, complete && solid.isWhole(), settings.set);
    result.rawContacts = static_cast<std::uint32_t>(s.found.size());
    result.collides = std::any_of(s.found.begin(), s.found.end(),
                                  [](const SurfaceContact& contact) { return contact.signedDistance <= 0; }) ||
                      (!complete && detail::penetrates(state.contacts));
    state.cutShort = !complete;
    state.searchPose = pose;
    state.searchDistance = settings.maxDistance;
    result.certain = complete && solid.isWhole();
    result.stop = complete ? StopReason::certain : StopReason::budget;
    result.work = purse.spent();
    return result;
}

std::uint64_t solidContactsAt(const MeshModel& mesh, const Solid& solid, const LocalContactSettings& settings,
                              Budget budget, std::vector<SurfaceContact>& out) {
    Purse purse(budget);
    if (purse.isUnlimited()) {
        return solid.contacts(mesh, settings.maxDistance, settings, out, nullptr);
    }
    Scratch& s = threadScratch();
    s.found.clear();
    PairState nothing;
    SolidSearch(mesh, solid, settings, purse, nothing, s).run({}, 0);
    out.insert(out.end(), s.found.begin(), s.found.end());
    return purse.spent();
}

}  // namespace grapeshot
