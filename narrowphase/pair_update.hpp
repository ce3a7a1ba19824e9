// One step of one pair of meshes: pose in, persistent contacts out.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <grapeshot/adb/query.hpp>
#include <grapeshot/core/budget.hpp>
#include <grapeshot/narrowphase/contact_set.hpp>
#include <grapeshot/narrowphase/local_contacts.hpp>
#include <grapeshot/narrowphase/mesh_model.hpp>
#include <grapeshot/narrowphase/method.hpp>
#include <grapeshot/scf/tracker.hpp>

namespace grapeshot {

/// Of Method::scf.
struct FeatureSettings {
    /// Work units of a step that may go into finding where the surfaces are near. As long as half of that is enough to
    /// traverse both ball trees, nothing is left to chance; else what was not reached is sampled, and features are
    /// tracked. unlimited: always traversed.
    std::uint64_t searchWork = 4096;
    std::uint64_t seed = 1;  ///< of the samples
    std::uint64_t pair = 0;  ///< of the two bodies, see `pairKey`
};

struct PairSettings {
    /// Pairs of which a model lacks `features` are left to adb.
    Method method = Method::automatic;
    FeatureSettings features;
    /// Surfaces closer than this are contacts, m (the host: margins + breaking threshold + what they approach in a
    /// step).
    float maxDistance = 0.06F;
    /// How far beyond maxDistance candidates are collected, m; while the bodies have moved less than that against
    /// each other, the traversal is skipped. 0: traverse every step. The contacts are the same either way.
    float slack = 0.02F;
    /// While the bodies have moved against each other by less than this since the contacts were last searched for (and
    /// that search was complete and no surfaces cut each other), the kept ones are only refreshed, m. 0: search every
    /// step. What comes within maxDistance meanwhile is found late, but never later than at maxDistance - reuseMotion,
    /// and a depth can be off by no more than that motion. Choose it smaller than the distance by which maxDistance
    /// exceeds touching.
    float reuseMotion = 0;
    Interior interior = Interior::solid;
    LocalContactSettings local;
    ContactSetSettings set;
};

/// A child of a node that a search in one tree has still to look into.
struct OpenChild {
    float distance = 0;  ///< no part of it is nearer than this, m
    ChildRef child = noChild;
    friend bool operator==(const OpenChild&, const OpenChild&) = default;
};

/// All that a pair remembers between steps; a value (copy it to save, assign it to restore: the following steps give
/// the same bytes). Candidates and search refer to the two models it was made with; see forgetSearch.
struct PairState {
    ContactSet contacts;
    /// Leaf pairs within candidateDistance in candidatePose, sorted; of a traversal that was cut short those that it
    /// has found, in its order.
    std::vector<LeafPair> candidates;
    Pose candidatePose;
    float candidateDistance = -1;  ///< m; negative: not all
    /// Cut short by a budget: goes on in the next step, for as long as the bodies stay within what it looks for.
    std::optional<Query> traversal;
    /// The same of a mesh against a solid: a heap, nearest first. Its candidates have leaf 0 of no tree as their
    /// second.
    std::vector<OpenChild> openChildren;
    float traversalDistance = -1;     ///< what it looks for, in candidatePose, m
    std::uint64_t traversalWork = 0;  ///< its work so far
    std::size_t nextCandidate = 0;    ///< where the tests go on if a budget ended them
    Pose searchPose;                  ///< of the last search
    float searchDistance = 0;         ///< its maxDistance, m
    /// It was complete, and its contacts may be refreshed. Set to false if a model's vertices moved, or if other
    /// settings than maxDistance are to take effect at once.
    bool searchHolds = false;
    bool cutShort = false;  ///< it was ended by a budget
    std::uint64_t step = 0;
    /// Method::scf: the features that are followed; refers to the models' `features`.
    std::optional<Tracker> tracker;
};

struct PairResult {
    bool collides = false;        ///< some contact with signedDistance <= 0
    bool certain = false;         ///< nothing within maxDistance (if refreshed: less reuseMotion) was left out
    bool sampled = false;         ///< features were tracked and sampled: `certain` is false even if the budget lasted
    Method method = Method::adb;  ///< adb or scf: which of the trees were asked
    StopReason stop = StopReason::invalidInput;
    std::uint64_t work = 0;
    std::uint32_t candidates = 0;    ///< leaf pairs tested; under a budget some twice
    bool traversed = false;          ///< the candidates were collected anew
    bool refreshed = false;          ///< only refreshed, not searched
    std::uint32_t rawContacts = 0;   ///< before regions and reduction
    std::uint32_t deepContacts = 0;  ///< from cuts (penetration beyond the search distance) and containment
    /// If sampled: pairs of pieces of both surfaces (see MissEstimate) that touch and where nothing was found, bound
    /// at 95 %; infinite if the budget ended before it was known.
    double missBound = 0;
};

/// Refresh, (traverse or track,) test, group, merge. On invalidInput (NaN or non-rigid pose) the state's contacts are
/// cleared and nothing is reported. Out of budget: what was found is merged, kept points stay, and `certain` is false;
/// the next call (in the same step or the next) goes on with the traversal and the tests where they stopped, after a
/// look (with at most half of the budget) at the triangles of the kept points, deepest first. A traversal begins anew
/// when the bodies have moved by more than the slack. A pair that has no contacts, or was cut short before, gets a
/// stand-in when the budget ends (stand_in.hpp), for which standInWork units (at most half of the budget) are kept.
/// Buffers are per thread.
PairResult update(const MeshModel& a, const MeshModel& b, const Pose& bInA, const PairSettings& settings, Budget budget,
                  PairState& state);

/// The models are other ones now, or their vertices have moved: the contacts are kept, the search is not.
void forgetSearch(PairState& state);

/// The contacts of one pose without memory, as `update` finds them but neither grouped nor reduced; bodies wholly
/// inside another give none. Appended to `out`, A's frame. Returns the work.
std::uint64_t contactsAt(const MeshModel& a, const MeshModel& b, const Pose& bInA, const PairSettings& settings,
                         Budget budget, std::vector<SurfaceContact>& out);

}  // namespace grapeshot
