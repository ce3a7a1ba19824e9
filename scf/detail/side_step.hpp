// The sides of the contacts of one step.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <grapeshot/core/topology.hpp>
#include <grapeshot/scf/detail/cells.hpp>
#include <grapeshot/scf/detail/key_map.hpp>
#include <grapeshot/scf/detail/posed_tree.hpp>
#include <grapeshot/scf/detail/side_memory.hpp>
#include <grapeshot/scf/detail/surface_probe.hpp>
#include <grapeshot/scf/side.hpp>

namespace grapeshot::detail {

/// Neighbours across split vertices.
struct SideBodies {
    SideBodies(const BallTree& treeA, const BallTree& treeB) : a(buildTopology(treeA.surface.mesh())) {
        if (&treeA != &treeB) {
            other.emplace(buildTopology(treeB.surface.mesh()));
        }
    }
    [[nodiscard]] const Topology& b() const { return other ? *other : a; }
    Topology a;
    std::optional<Topology> other;
};

/// Shared between copies, so everything is listed at once.
struct SideCells {
    struct OfTree {
        OfTree(const BallTree& tree, float size)
            : cells(cellsOfRadius(tree, size)), neighbours(neighboursOfAll(tree, cells)) {}
        Cells cells;
        IndexLists neighbours;
    };
    SideCells(const BallTree& treeA, const BallTree& treeB, float size) : spacing(size), a(treeA, size) {
        if (&treeA != &treeB) {
            other.emplace(treeB, size);
        }
    }
    [[nodiscard]] const OfTree& b() const { return other ? *other : a; }
    float spacing;
    OfTree a;
    std::optional<OfTree> other;
};

/// Positions at both ends of the step. No balls are asked for.
struct SideScratch {
    SideScratch(const BallTree& treeA, const BallTree& treeB)
        : beforeA(treeA), nowA(treeA), beforeB(treeB), nowB(treeB) {}
    PosedTree beforeA, nowA, beforeB, nowB;
    /// Sums of sides over pairs of cells.
    struct Votes {
        int ofA = 0, ofB = 0;
        void add(const ContactSides& sides) {
            ofA += sides.ofA;
            ofB += sides.ofB;
        }
    };
    std::vector<KeptSides> asked;
    KeyMap crossedA, crossedB;  ///< by cell, to the votes of what was crossed there a step ago
    std::vector<Votes> votes;
    std::vector<std::uint32_t> aroundA, aroundB;  ///< ids of cells
};

class SideStep {
  public:
    SideStep(const BallTree& a, const BallTree& b, const SideBodies& bodies, const SideCells& cells, SideMemory& memory,
             SideScratch& scratch)
        : m_a(a),
          m_b(b),
          m_cells(cells),
          m_memory(memory),
          m_scratch(scratch),
          m_beforeA(scratch.beforeA, bodies.a),
          m_nowA(scratch.nowA, bodies.a),
          m_beforeB(scratch.beforeB, bodies.b()),
          m_nowB(scratch.nowB, bodies.b()) {}

    /// False: a position at a contact is not finite.
    [[nodiscard]] bool begin(const SurfaceMotion& motionA, const SurfaceMotion& motionB,
                             std::span<const TrackedContact> contacts);
    void decide(std::span<const TrackedContact> contacts, std::vector<SidedContact>& out);
    /// Puts what was asked for into the memory.
    void finish(std::uint32_t keepSteps);

  private:
    /// Of a body with itself the lower cell comes first, and the sides change places with them.
    struct Key {
        std::uint64_t value = 0;
        bool isSwapped = false;
    };
    [[nodiscard]] Key keyOf(std::uint32_t idA, std::uint32_t idB) const;
    /// Of the pairs of cells around it, else of what was crossed a step ago in one of these cells: a body that is
    /// pushed on along itself, by more than a cell.
    [[nodiscard]] std::optional<ContactSides> inherited(const TrianglePair& pair);
    void listCrossed();
    /// Nothing if one is past the border of the other.
    [[nodiscard]] std::optional<ContactSides> atStart(const TrackedContact& contact) const;
    void present(const TrackedContact& contact, bool isKnown, SidedContact& sided) const;
    [[nodiscard]] bool isSelf() const { return &m_a == &m_b; }

    const BallTree& m_a;
    const BallTree& m_b;
    const SideCells& m_cells;
    SideMemory& m_memory;
    SideScratch& m_scratch;
    SurfaceProbe m_beforeA, m_nowA, m_beforeB, m_nowB;
};

}  // namespace grapeshot::detail
