// How deep are two surfaces in each other, region by region, and which way out?
//
// From the triangles that cut through each other the vertices behind the other surface are climbed, the deepest first,
// neighbour by neighbour; their closest points are followed from triangle to triangle. Such a point is never nearer
// than the surface is, so what a summit is said to be deep is an upper bound, and one search of the whole surface for
// its closest point makes it exact, or sends the climb on from there. The summits of a step are where the next begins.
//
// This work is based on:
// Bruno Heidelberger, Matthias Teschner, et al. Consistent Penetration Depth Estimation for Deformable Collision
// Response. VMV 2004 (depths spread from the intersection inwards)
// Ming Lin, John Canny. A fast algorithm for incremental distance calculation. ICRA 1991 (from the features before)
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <grapeshot/core/budget.hpp>
#include <grapeshot/core/error.hpp>
#include <grapeshot/core/triangle_pair.hpp>
#include <grapeshot/scf/ball_tree.hpp>
#include <grapeshot/scf/surface_state.hpp>
#include <grapeshot/scf/tracker.hpp>

namespace grapeshot {

struct DepthSettings {
    /// m, >= 0: cuts whose contacts are at most so far apart are one region; of contacts that were sampled about twice
    /// the tracker's spacing. 0: all overlapping pairs were given (TrackMode::exact), and those that share a vertex on
    /// both surfaces are one region: none is taken for a part of another. A summit before is then known again if the
    /// cut has moved by no more than a triangle.
    float spacing = 0.1F;
    /// Solids: is a piece of one that no contact cuts inside the other? Costs a search per piece whose vertex is in the
    /// box around the other.
    bool containment = true;
};

/// Of the sides on which two surfaces belong, at a contact: +1 where the other's normals point to, -1 behind. Of
/// solids, whose normals point outwards, both are +1.
struct ContactSides {
    std::int8_t ofA = 1;  ///< where B belongs, seen from A
    std::int8_t ofB = 1;  ///< where A belongs, seen from B
};

enum class DepthSource : std::uint8_t {
    vertexOfA,  ///< the deepest point is a vertex of A behind B's surface
    vertexOfB,  ///< the other way round
    crossing,   ///< no vertex is behind anything: edges cross each other, and triangles have to be parted so far
};

/// Everything in the common frame, in metres.
struct DepthRegion {
    /// Unit, on B pointing to A: along it A's deepest point gets back to B's surface, or B's out of A the other way.
    Eigen::Vector3f normal = Eigen::Vector3f::UnitY();
    /// >= 0: the largest distance to the other's surface of any vertex behind it that was climbed to, of both; of a
    /// crossing the largest translation that parts two of its triangles.
    float depth = 0;
    Eigen::Vector3f onA = Eigen::Vector3f::Zero();  ///< the deepest point, or the surface above it
    Eigen::Vector3f onB = Eigen::Vector3f::Zero();  ///< onA = onB - depth * normal
    DepthSource source = DepthSource::crossing;
    std::uint32_t vertex = 0;             ///< the deepest one; of a crossing 0
    std::uint32_t triangle = noTriangle;  ///< of the other body: the closest one; of a crossing B's
    std::uint8_t feature = 6;             ///< of that triangle: 0..2 corner, 3..5 edge, 6 face
    /// All of the other surface was searched for the closest point. Of solids without it (the budget had ended) the
    /// depth is an upper bound for this vertex; sheets are never searched.
    bool isChecked = false;
    std::uint32_t contacts = 0;  ///< cuts that were given and belong to it; 0: contained, or not seen in this step
    std::uint32_t age = 0;       ///< steps since it was found
};

/// What the next step begins with. A value: copied and saved as the caller likes.
struct DepthMemory {
    struct Summit {
        std::uint32_t vertex = 0;
        std::uint32_t triangle = 0;              ///< of the other body, the closest
        std::array<std::uint32_t, 4> anchors{};  ///< triangles of A in the cut, spread over it
        std::uint32_t age = 0;
        std::int8_t side = 1;
        bool isOfA = true;
        friend bool operator==(const Summit&, const Summit&) = default;
    };
    std::vector<Summit> summits;
    friend bool operator==(const DepthMemory&, const DepthMemory&) = default;
};

/// Little-endian.
[[nodiscard]] std::vector<std::byte> saveDepths(const DepthMemory& memory, const BallTree& a, const BallTree& b);
/// @throws Error badFile (not what `saveDepths` has written, or damaged), topologyChanged (of other meshes)
[[nodiscard]] DepthMemory loadDepths(std::span<const std::byte> bytes, const BallTree& a, const BallTree& b);

struct DepthResult {
    std::vector<DepthRegion> regions;  ///< in the order of their first contacts; then those without
    /// Every region was climbed and, of solids, its summit checked. It is the deepest of the vertices that a climb
    /// passes, not proven to be the deepest of all.
    bool complete = false;
    StopReason stop = StopReason::invalidInput;  ///< certain if complete
    /// With invalidInput: topologyChanged, notFinite, notRigid or badSetting. Nothing is listed then, and the memory is
    /// as before the step.
    std::optional<Fault> fault;
    std::uint64_t work = 0;
};

/// For one pair of bodies; keeps no more than scratch memory, so that an answer depends on its arguments alone: the
/// same bytes on every instruction set. The trees must stay where they are. Not for two threads.
class DepthQuery {
  public:
    /// Finds neighbours across split vertices, O(n log n).
    DepthQuery(const BallTree& a, const BallTree& b);
    /// Of a body with itself, which has to be a sheet: sides must be given.
    explicit DepthQuery(const BallTree& body);
    DepthQuery(DepthQuery&&) noexcept;
    DepthQuery& operator=(DepthQuery&&) noexcept;
    ~DepthQuery();

    /// @param contacts of this step. Those that overlap are cuts; of sheets also those that are on the wrong side
    /// @param sides of sheets, as many as contacts (see side.hpp). Empty: solids. Nothing is inside of an open or
    /// non-manifold mesh, so its partner's vertices are not climbed: if both are, all regions are crossings
    /// @param memory of the step before, or empty; then of this one
    /// The budget counts searched nodes and leaves, and steps from triangle to triangle (looks at up to sixteen); it
    /// may be exceeded by what one search needs. Regions that it did not reach are left out, and kept in the memory.
    [[nodiscard]] DepthResult measure(const SurfaceState& a, const SurfaceState& b,
                                      std::span<const TrackedContact> contacts, std::span<const ContactSides> sides,
                                      const DepthSettings& settings, DepthMemory& memory, Budget budget = {});
    /// Of a body with itself. @pre made of one tree, and the other of two: asserted
    [[nodiscard]] DepthResult measure(const SurfaceState& body, std::span<const TrackedContact> contacts,
                                      std::span<const ContactSides> sides, const DepthSettings& settings,
                                      DepthMemory& memory, Budget budget = {});

  private:
    struct State;
    std::unique_ptr<State> m_state;
};

}  // namespace grapeshot
