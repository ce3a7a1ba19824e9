// One step of one pair of meshes: pose in, persistent contacts out.
#pragma once

#include <cstdint>
#include <vector>

#include <grapeshot/adb/query.hpp>
#include <grapeshot/core/budget.hpp>
#include <grapeshot/narrowphase/contact_set.hpp>
#include <grapeshot/narrowphase/local_contacts.hpp>
#include <grapeshot/narrowphase/mesh_model.hpp>

namespace grapeshot {

struct PairSettings {
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

/// All that a pair remembers between steps; a value (copy it to save, assign it to restore: the following steps give
/// the same bytes). Candidates and search refer to the two models it was made with.
struct PairState {
    ContactSet contacts;
    std::vector<LeafPair> candidates;  ///< leaf pairs within candidateDistance in candidatePose, sorted
    Pose candidatePose;
    float candidateDistance = -1;  ///< m; negative: none kept
    Pose searchPose;               ///< of the last search
    float searchDistance = 0;      ///< its maxDistance, m
    /// It was complete, and its contacts may be refreshed. Set to false if a model's vertices moved, or if other
    /// settings than maxDistance are to take effect at once.
    bool searchHolds = false;
    std::uint64_t step = 0;
};

struct PairResult {
    bool collides = false;  ///< some contact with signedDistance <= 0
    bool certain = false;   ///< nothing within maxDistance (if refreshed: less reuseMotion) was left out
    StopReason stop = StopReason::invalidInput;
    std::uint64_t work = 0;
    std::uint32_t candidates = 0;    ///< leaf pairs tested; under a budget some twice
    bool traversed = false;          ///< the candidates were collected anew
    bool refreshed = false;          ///< only refreshed, not searched
    std::uint32_t rawContacts = 0;   ///< before regions and reduction
    std::uint32_t deepContacts = 0;  ///< from cuts (penetration beyond the search distance) and containment
};

/// Refresh, (traverse,) test, group, merge. On invalidInput (NaN or non-rigid pose) the state's contacts are cleared
/// and nothing is reported. Out of budget: what was found is merged, kept points stay, `certain` is false, and the next
/// step starts with a traversal. Buffers are per thread.
PairResult update(const MeshModel& a, const MeshModel& b, const Pose& bInA, const PairSettings& settings, Budget budget,
                  PairState& state);

/// The contacts of one pose without memory, as `update` finds them but neither grouped nor reduced; bodies wholly
/// inside another give none. Appended to `out`, A's frame. Returns the work.
std::uint64_t contactsAt(const MeshModel& a, const MeshModel& b, const Pose& bInA, const PairSettings& settings,
                         Budget budget, std::vector<SurfaceContact>& out);

}  // namespace grapeshot
