// One continuous step of a tracker: what touches at any moment of it, by time.
#pragma once

#include <cstdint>
#include <vector>

#include <grapeshot/core/random.hpp>
#include <grapeshot/scf/detail/impact_search.hpp>
#include <grapeshot/scf/detail/impact_space.hpp>
#include <grapeshot/scf/detail/meter.hpp>
#include <grapeshot/scf/detail/tracker_state.hpp>

namespace grapeshot::detail {

class TrackMotion {
  public:
    TrackMotion(const ImpactSpace& space, const TrackSettings& settings, Meter& meter, TrackerMemory& memory,
                TrackerScratch& scratch, TrackResult& out);

    /// The parts of the step in their order, the trees having begun each. False: the budget ended, so no other may
    /// follow.
    bool run(const StepPart& part);
    /// Puts what is to be tracked next into the memory.
    void finish();
    [[nodiscard]] std::uint64_t work() const { return m_work; }

  private:
    [[nodiscard]] bool hasMoreThan(std::uint64_t spare);
    [[nodiscard]] LanePair lanesOf(const TrianglePair& pair) const;
    [[nodiscard]] std::uint64_t keyOf(TrianglePair pair) const;
    /// Has the pair of cells that these pieces lie in a contact that stands for all?
    [[nodiscard]] bool isSettled(const WaitingPair& pieces) const;

    void testTracked(double share);
    bool search(ImpactFront& front, std::uint64_t spare);
    void open(ImpactFront& front);
    void advanceEarliest(ImpactFront& front);
    /// What is not finished after some rounds waits in the front.
    void advance(ImpactFront& front, const LanePair* pairs, float (&time)[16], int count);
    void accept(int lane, float time);
    void audit();

    const ImpactSpace& m_space;
    const TrackSettings& m_settings;
    Meter& m_meter;
    TrackerMemory& m_memory;
    TrackerScratch& m_scratch;
    TrackResult& m_out;
    RandomKey m_key;
    std::uint32_t m_draw = 0;
    std::uint64_t m_work = 0;
    StepPart m_part;
    std::size_t m_known = 0;  ///< contacts before the sample
    bool m_isNew = false;     ///< something was accepted that was not known before it
    bool m_isComplete = true;
};

}  // namespace grapeshot::detail
