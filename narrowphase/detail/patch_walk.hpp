// From leaf pairs that are known to touch over the neighbourhood, on both surfaces, to all that hangs together with
// them: a hit brings the whole patch of contact in the same step, without another traversal.
//
// This work is based on:
// Stefan Kimmerle, Matthieu Nesme, Francois Faure. Hierarchy Accelerated Stochastic Collision Detection. VMV 2004 (a
// collision spreads over the neighbours of its features)
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <grapeshot/core/purse.hpp>
#include <grapeshot/narrowphase/detail/key_table.hpp>
#include <grapeshot/narrowphase/local_contacts.hpp>

namespace grapeshot::detail {

/// Where two surfaces are within a distance along a patch, so are the boxes of the leaves along it, and two that follow
/// each other share an edge on one side. So the walk leaves nothing out of a patch that it has begun.
class PatchWalk {
  public:
    /// Forgets everything; memory is kept. The models must stay.
    void start(const MeshModel& a, const MeshModel& b);
    /// Once each, however often it is told.
    void seed(const LeafPair& pair);
    /// From the seeds on, first come, first served, as long as there is something left: tests what is within the
    /// search's distance, and its neighbours. A look at sixteen of these is one unit. True if nothing is left to do.
    bool run(Purse& purse, LocalContactSearch& search);

    /// Within the distance, in the order in which they were reached; the seeds among them.
    [[nodiscard]] std::span<const LeafPair> reached() const { return m_reached; }

  private:
    /// A copy: the list of seeds may move.
    void spreadFrom(LeafPair pair);
    void addNeighbours(const MeshModel& model, std::uint32_t leaf);

    const MeshModel* m_a = nullptr;
    const MeshModel* m_b = nullptr;
    KeyTable m_seen;
    std::vector<LeafPair> m_open;
    std::size_t m_next = 0;  ///< in m_open
    std::vector<LeafPair> m_reached;
    std::vector<std::uint32_t> m_neighbours;
    std::uint64_t m_looks = 0;  ///< not paid yet
};

}  // namespace grapeshot::detail
