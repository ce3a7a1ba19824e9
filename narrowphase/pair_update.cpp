#include <grapeshot/narrowphase/pair_update.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include <grapeshot/narrowphase/detail/leaf_filter.hpp>
#include <grapeshot/narrowphase/penetration.hpp>

namespace grapeshot {
namespace {

/// What is left of a budget that several parts share.
class Purse {
  public:
    explicit Purse(const Budget& budget) : m_budget(budget) {
        if (m_budget.time != never) {
            m_start = now();
        }
    }
    void pay(std::uint64_t work) { m_spent += work; }
    [[nodiscard]] std::uint64_t spent() const { return m_spent; }
    [[nodiscard]] bool isUnlimited() const { return m_budget.work == unlimited && m_budget.time == never; }
    [[nodiscard]] Budget left() const {
        Budget rest = m_budget;
        if (rest.work != unlimited) {
            rest.work -= std::min(rest.work, m_spent);
        }
        if (rest.time != never) {
            rest.time = std::max(std::chrono::nanoseconds(0), rest.time - (now() - m_start));
        }
        return rest;
    }
    [[nodiscard]] bool isEmpty() const {
        const Budget rest = left();
        return rest.work == 0 || rest.time <= std::chrono::nanoseconds(0);
    }

  private:
    [[nodiscard]] std::chrono::nanoseconds now() const {
        return m_budget.clock != nullptr ? m_budget.clock()
                                         : std::chrono::duration_cast<std::chrono::nanoseconds>(
                                               std::chrono::steady_clock::now().time_since_epoch());
    }
    Budget m_budget;
    std::chrono::nanoseconds m_start{0};
    std::uint64_t m_spent = 0;
};

/// Contacts of one leaf pair, while pairs are tested in another order than they are listed in.
struct Tested {
    LeafPair pair;
    std::uint32_t begin = 0;
    std::uint32_t end = 0;
};

struct Scratch {
    LeafPairs leafPairs;
    Contacts contacts;
    std::vector<TriangleContact> unordered;
    std::vector<Tested> tested;
    std::vector<LeafPair> near;
    std::vector<TriangleContact> pairs;  ///< the step's triangle pairs, by ascending leaf pair
    std::vector<SurfaceContact> found;
};

Scratch& threadScratch() {
    thread_local Scratch scratch;
    return scratch;
}

bool isUsable(const PairSettings& settings) {
    const auto isLength = [](float value) { return std::isfinite(value) && value >= 0.0F; };
    return isLength(settings.maxDistance) && isLength(settings.slack) && isLength(settings.set.maxDistance) &&
           isLength(settings.set.mergeDistance) && settings.set.mergeDistance > 0.0F &&
           isLength(settings.set.regions.spacing) && settings.set.regions.spacing > 0.0F &&
           std::isfinite(settings.set.keepCone) && std::isfinite(settings.set.regions.normalCone) &&
           isLength(settings.local.lean);
}

/// Can a pair of triangles within maxDistance be missing from the kept candidates?
bool canReuse(const MeshModel& a, const MeshModel& b, const Pose& bInA, const PairSettings& settings,
              const PairState& state) {
    if (state.candidateDistance < 0.0F || settings.slack <= 0.0F) {
        return false;
    }
    // Points of B in A's frame, or points of A in B's: either bounds the change of every distance.
    const float moved = std::min(motionBound(state.candidatePose, bInA, b.tree.radius),
                                 motionBound(inverse(state.candidatePose), inverse(bInA), a.tree.radius) +
                                     // The inverse poses are rounded.
                                     1e-6F * (state.candidatePose.translation.norm() + bInA.translation.norm()));
    const float rounding = 4e-6F * (a.tree.radius + b.tree.radius);
    return moved + rounding + settings.maxDistance <= state.candidateDistance;
}

/// Triangle pairs of the kept candidates. True if all were tested.
bool testCandidates(const MeshModel& a, const MeshModel& b, Query& query, const Pose& bInA,
                    const PairSettings& settings, const PairState& state, Purse& purse, PairResult& result,
                    Scratch& s) {
    purse.pay(detail::nearPairs(a, b, bInA, state.candidates, settings.maxDistance, purse.left().work, s.near));
    query.contactsOf(s.near, bInA, settings.maxDistance, purse.left(), s.contacts);
    purse.pay(s.contacts.work);
    result.candidates = static_cast<std::uint32_t>(s.contacts.work);
    s.pairs.swap(s.contacts.pairs);
    return s.contacts.certain;
}

/// Traversal and tests in turns, so that a small budget finds some contacts before it knows all candidates. The turns
/// do not depend on the budget, so a larger one does what a smaller one does, and more. True if all were found.
bool traverseInTurns(const MeshModel& a, const MeshModel& b, Query& traversal, const Pose& bInA,
                     const PairSettings& settings, PairState& state, Purse& purse, PairResult& result, Scratch& s) {
    Query tests(a.tree, b.tree);  // the other one is to be resumed
    s.unordered.clear();
    s.tested.clear();
    s.leafPairs.pairs.clear();
    s.leafPairs.certain = false;
    const float reach = settings.maxDistance + settings.slack;
    std::size_t testedUntil = 0;
    std::uint64_t traversalWork = 0;
    std::uint64_t turn = 1;
    for (bool started = false; !purse.isEmpty(); started = true) {
        if (!s.leafPairs.certain) {
            Budget slice = purse.left();
            slice.work = std::min(slice.work, turn);
            turn = std::min<std::uint64_t>(2 * turn, 32);
            if (started) {
                traversal.resumeLeafPairs(slice, s.leafPairs);
            } else {
                traversal.leafPairs(bInA, {reach, Order::bestFirst}, slice, s.leafPairs);
            }
            if (s.leafPairs.stop == StopReason::invalidInput) {
                return false;
            }
            purse.pay(s.leafPairs.work - traversalWork);
            traversalWork = s.leafPairs.work;
        }
        purse.pay(detail::nearPairs(a, b, bInA, std::span(s.leafPairs.pairs).subspan(testedUntil), settings.maxDistance,
                                    purse.left().work, s.near));
        // One at a time, to know which contacts are whose.
        std::size_t done = 0;
        for (; done < s.near.size() && !purse.isEmpty(); ++done) {
            tests.contactsOf({&s.near[done], 1}, bInA, settings.maxDistance, purse.left(), s.contacts);
            purse.pay(s.contacts.work);
            if (!s.contacts.certain) {
                break;
            }
            const auto begin = static_cast<std::uint32_t>(s.unordered.size());
            s.unordered.insert(s.unordered.end(), s.contacts.pairs.begin(), s.contacts.pairs.end());
            s.tested.push_back({s.near[done], begin, static_cast<std::uint32_t>(s.unordered.size())});
        }
        if (done < s.near.size()) {
            break;
        }
        testedUntil = s.leafPairs.pairs.size();
        if (s.leafPairs.certain) {
            break;
        }
    }
    result.candidates = static_cast<std::uint32_t>(s.tested.size());
    std::sort(s.tested.begin(), s.tested.end(),
              [](const Tested& left, const Tested& right) { return left.pair < right.pair; });
    s.pairs.clear();
    for (const Tested& tested : s.tested) {
        s.pairs.insert(s.pairs.end(), s.unordered.begin() + tested.begin, s.unordered.begin() + tested.end);
    }
    if (s.leafPairs.certain) {
        state.candidates.assign(s.leafPairs.pairs.begin(), s.leafPairs.pairs.end());
        std::sort(state.candidates.begin(), state.candidates.end());
        state.candidateDistance = settings.maxDistance + settings.slack;
    }
    return s.leafPairs.certain && testedUntil == s.leafPairs.pairs.size();
}

/// Fills s.pairs. True if no triangle pair within maxDistance is missing.
bool findPairs(const MeshModel& a, const MeshModel& b, const Pose& bInA, const PairSettings& settings, Purse& purse,
               PairState& state, PairResult& result, Scratch& s) {
    Query query(a.tree, b.tree);
    if (canReuse(a, b, bInA, settings, state)) {
        return testCandidates(a, b, query, bInA, settings, state, purse, result, s);
    }
    result.traversed = true;
    state.candidatePose = bInA;
    state.candidateDistance = -1;
    state.candidates.clear();
    if (!purse.isUnlimited()) {
        return traverseInTurns(a, b, query, bInA, settings, state, purse, result, s);
    }
    query.leafPairs(bInA, {settings.maxDistance + settings.slack, Order::depthFirst}, purse.left(), s.leafPairs);
    purse.pay(s.leafPairs.work);
    if (!s.leafPairs.certain) {
        return false;
    }
    state.candidates.assign(s.leafPairs.pairs.begin(), s.leafPairs.pairs.end());
    std::sort(state.candidates.begin(), state.candidates.end());
    state.candidateDistance = settings.maxDistance + settings.slack;
    return testCandidates(a, b, query, bInA, settings, state, purse, result, s);
}

/// Local extrema, cuts that they do not explain, and bodies inside bodies.
void findContacts(const MeshModel& a, const MeshModel& b, const Pose& bInA, const PairSettings& settings, bool complete,
                  PairResult& result, Scratch& s) {
    s.found.clear();
    LocalContactSettings local = settings.local;
    local.maxDistance = std::min(local.maxDistance, settings.maxDistance);
    localContacts(a, b, bInA, s.pairs, local, s.found);
    const std::size_t localCount = s.found.size();
    const bool overlapping =
        std::any_of(s.pairs.begin(), s.pairs.end(), [](const TriangleContact& pair) { return pair.overlapping; });
    if (overlapping) {
        thread_local std::vector<SurfaceContact> deep;
        deep.clear();
        const float spacing = settings.set.regions.spacing;
        penetrationContacts(a, b, bInA, s.pairs, s.found, {spacing, spacing, maxPointsPerRegion}, deep);
        s.found.insert(s.found.end(), deep.begin(), deep.end());
    } else if (complete && settings.interior == Interior::solid && s.found.empty()) {
        containmentContacts(a, b, bInA, s.found);
    }
    result.rawContacts = static_cast<std::uint32_t>(s.found.size());
    result.deepContacts = static_cast<std::uint32_t>(s.found.size() - localCount);
    result.collides = overlapping || std::any_of(s.found.begin(), s.found.end(), [](const SurfaceContact& contact) {
                          return contact.signedDistance <= 0.0F;
                      });
}

}  // namespace

PairResult update(const MeshModel& a, const MeshModel& b, const Pose& bInA, const PairSettings& settings, Budget budget,
                  PairState& state) {
    PairResult result;
    ++state.step;
    if (!isRigid(bInA) || !isUsable(settings)) {
        state.contacts.slots.clear();
        state.contacts.droppedRegions = 0;
        state.candidates.clear();
        state.candidateDistance = -1;
        return result;
    }
    Scratch& s = threadScratch();
    Purse purse(budget);
    refresh(state.contacts, bInA, settings.set);
    s.pairs.clear();
    const bool complete = findPairs(a, b, bInA, settings, purse, state, result, s);
    findContacts(a, b, bInA, settings, complete, result, s);
    merge(state.contacts, s.found, bInA, complete, settings.set);
    if (!complete) {
        // Whatever is kept may be incomplete now, and what was left out may be what matters.
        state.candidateDistance = -1;
        for (const RegionSlot& slot : state.contacts.slots) {
            for (int i = 0; i < slot.count; ++i) {
                result.collides = result.collides || slot.points[static_cast<std::size_t>(i)].signedDistance <= 0.0F;
            }
        }
    }
    result.certain = complete;
    result.stop = complete ? StopReason::certain : StopReason::budget;
    result.work = purse.spent();
    return result;
}

float motionBound(const Pose& before, const Pose& now, float radiusOfB) {
    const Eigen::Matrix3d first = before.rotation.cast<double>();
    const Eigen::Matrix3d second = now.rotation.cast<double>();
    // The difference of two rotations has two equal singular values and a zero: its spectral norm is its Frobenius norm
    // by sqrt(2). How far each matrix is from a rotation is at most |R^T R - I|, and comes on top.
    const double offFirst = (first.transpose() * first - Eigen::Matrix3d::Identity()).norm();
    const double offSecond = (second.transpose() * second - Eigen::Matrix3d::Identity()).norm();
    const double off = offFirst + offSecond;
    const double turn = ((second - first).norm() + off) / std::sqrt(2.0) + off;
    const double shift = (now.translation.cast<double>() - before.translation.cast<double>()).norm();
    const double bound = turn * static_cast<double>(radiusOfB) + shift;
    return std::nextafter(static_cast<float>(bound * (1 + 1e-12)), INFINITY);
}

}  // namespace grapeshot
