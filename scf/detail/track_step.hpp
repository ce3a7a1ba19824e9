// One step of a tracker, in its parts.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include <grapeshot/core/random.hpp>
#include <grapeshot/scf/detail/descent.hpp>
#include <grapeshot/scf/detail/meter.hpp>
#include <grapeshot/scf/detail/tracker_state.hpp>

namespace grapeshot::detail {

class TrackStep {
  public:
    /// @param nearer m, by how much the surfaces may have come nearer since the step before; infinite: there was none;
    /// nothing: nor will it be known in the next
    TrackStep(const PairSpace& space, const TrackSettings& settings, const Budget& budget, std::optional<float> nearer,
              TrackerMemory& memory, TrackerScratch& scratch, TrackResult& out);

    void exact();
    void resolution();
    void sampled();

    [[nodiscard]] std::uint64_t work() const { return m_work + m_scratch.search.work(); }
    /// Were all positions finite that were read?
    [[nodiscard]] bool isFinite() const;
    /// Puts what is to be tracked next into the memory.
    void finish();

  private:
    [[nodiscard]] float unit() { return randomUnit(m_key, m_draw++); }
    [[nodiscard]] std::uint64_t below(std::uint64_t count) { return randomBits(m_key, m_draw++) % count; }
    [[nodiscard]] std::uint64_t left() { return m_meter.left(work()); }

    /// The tracked pairs: those in contact stay, the others are followed. Uses up to `share` of the budget.
    void testTracked(double share);
    /// False: one was there already in its place.
    bool accept(const PairBatch& batch, int lane, std::uint64_t birth);
    /// Lists a contact even if there is one in its place, because it is in another pair of cells of the front.
    void report(const PairBatch& batch, int lane);
    void keepNear(const TrianglePair& pair, std::uint64_t birth);
    /// Lists it besides, if it is ahead.
    void keepNear(const TrackedContact& nearest, std::uint64_t birth);
    [[nodiscard]] std::uint64_t keyOf(const TrianglePair& pair) const;
    [[nodiscard]] static std::uint64_t joined(std::uint32_t a, std::uint32_t b) { return std::uint64_t{a} << 32U | b; }
    [[nodiscard]] std::uint64_t cellKey(const Cells& a, const Cells& b, const TrianglePair& pair) const;

    /// m a step: when all is faster, hardly anything is known for longer than a step, and remembering it costs more
    /// than to look again. Of a leaf's size; under a budget, where the traversal ends at larger pieces, of the spacing.
    [[nodiscard]] float fastestKept() const;
    [[nodiscard]] FrontKey frontKey() const;
    void beginFront();
    [[nodiscard]] Clearance clearanceToFind() const;
    /// m, beyond the reach; 0: nothing is looked for there.
    [[nodiscard]] float ahead() const { return m_wide.reach - m_space.reach; }
    void exactByFront();
    bool listCandidates(std::uint64_t limit);
    void sumWeights();
    [[nodiscard]] BallPair drawCandidate(double place) const;
    /// Down to two leaves, test, repair. True: it found a contact, whose key is in m_lastKey.
    bool dive(BallPair pair, bool greedy);
    /// One level down: to the pair that overlaps most, or to one drawn by that. False: none does.
    bool goDown(BallPair& pair, bool greedy);
    /// The rest of a dive, at two leaves.
    bool land(const BallPair& pair, bool greedy);
    [[nodiscard]] bool mayDive(std::uint64_t spare) {
        const std::uint64_t rest = left();
        return rest > 0 && (rest == unlimited || rest > spare);
    }
    /// Dives from all of these pairs, side by side. Those that the budget leaves in the water, at the end, are gone.
    void diveTogether(std::span<BallPair> pairs, std::uint64_t spare);
    bool repair(const VertexPair& from, std::uint64_t birth);
    /// The triangles around two vertices. True: contact.
    bool testFans(const VertexPair& vertices, std::uint64_t birth);
    [[nodiscard]] bool isCoarse(const BallPair& pair) const;
    /// Nothing around the two vertices can be left out.
    [[nodiscard]] bool isFarAtRest(const VertexPair& vertices) const;
    /// Looks into the cells beside a contact.
    void walkFrom(std::uint32_t contact);
    void walk(std::uint64_t spare);
    void diveOn(std::uint64_t spare);
    /// The uniform sample of candidates without a contact.
    void audit(bool complete);

    const PairSpace& m_space;
    const TrackSettings& m_settings;
    Meter m_meter;
    float m_nearer;
    PairSpace m_wide;          ///< with what is ahead within its reach
    float m_follow = 0;        ///< m, beyond the reach
    float m_way = 0;           ///< m: what the surfaces are expected to come nearer in a step
    bool m_usesFront = false;  ///< the traversal goes by what is remembered
    TrackerMemory& m_memory;
    TrackerScratch& m_scratch;
    TrackResult& m_out;
    const Cells& m_cellsA;
    const Cells& m_cellsB;
    const Cells& m_frontA;
    const Cells& m_frontB;
    RandomKey m_key;
    std::uint32_t m_draw = 0;
    std::uint64_t m_work = 0;
    std::uint64_t m_lastKey = 0;
    std::uint64_t m_foundOnce = 0;
    float m_testPrice;
    std::size_t m_untested = 0;  ///< tracked pairs from here on stay as they are
};

}  // namespace grapeshot::detail
