// From leaf pairs near each other to the contacts that matter: those where the distance between the surfaces is locally
// smallest (or the penetration locally deepest).
//
// A pair of triangles that are merely near is no contact: next to a true one there are many with slanted directions,
// which make bodies trip over the inner edges of flat faces. A pair of features is a contact if, at both witness
// points, every surface direction leads away from the other body within an angular tolerance (the Voronoi-region test
// of Lin and Canny, 1991, for non-convex surfaces and with tolerance), and if it faces the right way: n against A's
// outward normal and along B's.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include <grapeshot/adb/query.hpp>
#include <grapeshot/core/budget.hpp>
#include <grapeshot/narrowphase/mesh_model.hpp>
#include <grapeshot/narrowphase/surface_contact.hpp>

namespace grapeshot {

struct LocalContactSettings {
    /// Sine of the angle by which a surface may lean towards the other body and still count as locally closest. Larger:
    /// nearly parallel faces give all their corners at once (stable rest), but slanted directions survive.
    float lean = 0.08F;
    /// Contacts farther apart than this are left out, m.
    float maxDistance = std::numeric_limits<float>::infinity();
};

/// Contacts among the triangles of leaf pairs that are local extrema, each pair of features once: corner on face, on
/// edge or on corner, edge on edge. Corners of nearly parallel triangles all count. The sign follows the outward
/// normals of whichever side is solid: a corner behind the other's surface is a penetration with the depth to it,
/// deeper than maxDistance only where its triangle cuts the other; it must really be inside, with nothing between.
/// Between two sheets all distances are positive. What the corners and crossing edges do not tell of a cut is left to
/// penetration.hpp.
///
/// An object to be used again and again: it keeps its memory. Refers to the two models until `finish`.
class LocalContactSearch {
  public:
    LocalContactSearch();
    ~LocalContactSearch();
    LocalContactSearch(const LocalContactSearch&) = delete;
    LocalContactSearch& operator=(const LocalContactSearch&) = delete;

    void start(const MeshModel& a, const MeshModel& b, const Pose& bInA, const LocalContactSettings& settings);
    /// Tests leaf pairs from the front as long as the work lasts; returns how many it is done with. Each costs up to
    /// three units. Boxes that are farther apart than maxDistance, surfaces that neither face each other nor cross, and
    /// the insides of two flat faces cost nothing.
    std::size_t add(std::span<const LeafPair> pairs, std::uint64_t mostWork = unlimited);
    /// The same of up to `fewPairs`. @param near bit i: the boxes of pair i are within maxDistance
    std::size_t addFew(std::span<const LeafPair> pairs, std::uint64_t mostWork, std::uint32_t& near);
    static constexpr std::size_t fewPairs = 16;
    /// Appends the contacts in A's frame. Nothing depends on the order of the leaf pairs.
    void finish(std::vector<SurfaceContact>& out);

    [[nodiscard]] std::uint64_t work() const;    ///< units since `start`
    [[nodiscard]] std::uint32_t tested() const;  ///< leaf pairs that cost something
    /// Triangle pairs that cut each other, for penetrationContacts; after `finish` ascending.
    [[nodiscard]] std::span<const TriangleContact> overlapping() const;

  private:
    struct State;
    std::unique_ptr<State> m_state;
};

/// The same by brute force: every pair of features of the given triangle pairs is tested, without any filter. The
/// truth that LocalContactSearch is held against; hundreds of times slower.
void localContactsExhaustive(const MeshModel& a, const MeshModel& b, const Pose& bInA,
                             std::span<const TrianglePair> pairs, const LocalContactSettings& settings,
                             std::vector<SurfaceContact>& out);

}  // namespace grapeshot
