// Which regions of contact a running world has found, and how soon; against an exact search in the same poses.
#pragma once

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include <grapeshot/narrowphase/pair_update.hpp>
#include <scenes/world.hpp>

namespace grapeshot::bench {

struct RegionCounts {
    std::uint64_t regions = 0;    ///< that were there for two steps, or found
    std::uint64_t atFirst = 0;    ///< of these, found in their first step
    std::uint64_t withinTwo = 0;  ///< ... or their second
    std::uint64_t brief = 0;      ///< gone after one step without being found: not judged
    /// Of the step in which a region is found: the difference of its push from the one that an exact search gives it in
    /// the pair's place, from the same contacts of the step before, as a share of that; of the turning moment about A's
    /// origin, as a share of the push times its distance. A contact pushes by how far it is within the distance. (Of
    /// many contacts a region keeps four, others after other steps before: the exact search's own region may push
    /// otherwise with nothing missed.)
    std::vector<double> forceErrors, torqueErrors;
};

/// A region is what adb, with nothing left out, keeps under one name in the poses that the world goes through. It is
/// found if a contact of the world's pair belongs to it: within the spacing and the cone of normals of one of its
/// contacts. Only pairs of meshes count.
class RegionWatch {
  public:
    explicit RegionWatch(const Settings& settings) : m_settings(settings) {}
    /// Everything before the step, because contacts are searched for at its begin.
    void before(scenes::World& world);
    void after(scenes::World& world);
    [[nodiscard]] const RegionCounts& counts() const { return m_counts; }

  private:
    struct Life {
        int age = 0;    ///< steps
        int found = 0;  ///< in which; 0: not yet
        bool counted = false;
    };
    struct Truth {
        PairState state;
        std::map<std::uint32_t, Life> lives;
    };
    /// A pair in one step.
    struct Step {
        const MeshModel& a;
        const MeshModel& b;
        Pose bInA;
        PairSettings exact;
        const PairState& before;  ///< the pair's own
    };
    void compare(const ContactSet& found, const Step& step, Truth& truth);
    void count(Life& life);

    Settings m_settings;  ///< of the world
    std::vector<btTransform> m_poses;
    std::map<std::pair<int, int>, PairState> m_before;
    std::map<std::pair<int, int>, Truth> m_truths;
    RegionCounts m_counts;
};

}  // namespace grapeshot::bench
