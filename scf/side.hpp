// On which side of each other do two sheets belong, or a sheet of itself? Kept from when they were apart, never read
// off from where they are: triangles that overlap do not say where they came from.
//
// This work is based on:
// Robert Bridson, Ronald Fedkiw, John Anderson. Robust Treatment of Collisions, Contact and Friction for Cloth
// Animation. SIGGRAPH 2002 (what is free at the start of a step stays so)
// David Baraff, Andrew Witkin, Michael Kass. Untangling Cloth. SIGGRAPH 2003 (what happens if nothing is remembered)
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <grapeshot/core/error.hpp>
#include <grapeshot/scf/ball_tree.hpp>
#include <grapeshot/scf/depth.hpp>
#include <grapeshot/scf/motion.hpp>
#include <grapeshot/scf/tracker.hpp>

namespace grapeshot {

struct SideSettings {
    /// m, > 0: contacts in the same pair of cells of about this size share their sides. The tracker's, say.
    float spacing = 0.05F;
    /// Sides that no contact has asked for are forgotten after so many steps. Long: a sheet that goes round the border
    /// of another in the meantime is pulled back over it. Short: one that was pushed through and was not found again in
    /// time stays there.
    std::uint32_t keepSteps = 16;
};

enum class SideSource : std::uint8_t {
    kept,       ///< from an earlier contact of the same cells
    inherited,  ///< from earlier contacts of the cells around them
    start,      ///< from the start of this step
    none,       ///< there one is past the border of the other: as it is now
};

/// What the sides make of a contact. In the common frame, at the end of the step.
struct SidedContact {
    ContactSides sides;
    SideSource source = SideSource::none;
    bool isCrossed = false;  ///< overlapping, or apart on the wrong side
    /// Unit, on B pointing to where A belongs.
    Eigen::Vector3f normal = Eigen::Vector3f::UnitY();
    float signedDistance = 0;  ///< m; minus the distance if apart on the wrong side
};

struct SideResult {
    std::vector<SidedContact> contacts;  ///< as many as were given
    /// topologyChanged, notFinite, notRigid or badSetting. Nothing is listed then, and the keeper is as before.
    std::optional<Fault> fault;
    std::size_t kept = 0;  ///< pairs of cells that have sides for the next step

    /// As DepthQuery takes them.
    [[nodiscard]] std::vector<ContactSides> sides() const;
};

/// A value: a copy goes on by itself, with the same results. Same inputs: same bytes, on every instruction set. The
/// trees must stay where they are. Not for two threads at once. One that was moved from may only be copied, assigned to
/// or destroyed.
class SideKeeper {
  public:
    /// Finds neighbours across split vertices, O(n log n); copies share them.
    SideKeeper(const BallTree& a, const BallTree& b);
    /// Of a body with itself.
    explicit SideKeeper(const BallTree& body);
    SideKeeper(const SideKeeper&);
    SideKeeper& operator=(const SideKeeper&);
    SideKeeper(SideKeeper&&) noexcept;
    SideKeeper& operator=(SideKeeper&&) noexcept;
    ~SideKeeper();

    /// @param a, b both ends of the step. The start has to be free where a contact is new; the first step of all may
    /// have the same positions at both ends
    /// @param contacts at the end of the step. Only positions around them are read and checked for being finite; the
    /// stretch is not looked at
    /// Some 2 us for a new contact, 0.3 for another. The first step after a change of `spacing` cuts the surfaces,
    /// O(n).
    [[nodiscard]] SideResult step(const SurfaceMotion& a, const SurfaceMotion& b,
                                  std::span<const TrackedContact> contacts, const SideSettings& settings = {});
    /// Of a body with itself. @pre made of one tree, and the other of two: asserted
    [[nodiscard]] SideResult step(const SurfaceMotion& body, std::span<const TrackedContact> contacts,
                                  const SideSettings& settings = {});

    /// Forgets all sides: after a jump, say.
    void clear();
    /// All that the next steps depend on beside their arguments, little-endian.
    [[nodiscard]] std::vector<std::byte> save() const;
    /// In place of the state. @throws Error badFile (not what `save` has written, or damaged), topologyChanged (of
    /// other meshes); the keeper is then as before
    void load(std::span<const std::byte> bytes);

  private:
    struct State;
    std::unique_ptr<State> m_state;
};

}  // namespace grapeshot
