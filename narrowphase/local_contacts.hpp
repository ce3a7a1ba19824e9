// From triangle pairs within a distance to the contacts that matter: those where the distance between the surfaces is
// locally smallest (or the penetration locally deepest).
//
// A pair of triangles that are merely near is no contact: next to a true one there are many with slanted directions,
// which make bodies trip over the inner edges of flat faces. A contact is kept if, at both witness points, every
// surface direction leads away from the other body within an angular tolerance (the Voronoi-region test of Lin and
// Canny, 1991, for non-convex surfaces and with tolerance), and if it faces the right way: n against A's outward normal
// and along B's.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include <grapeshot/adb/query.hpp>
#include <grapeshot/narrowphase/mesh_model.hpp>
#include <grapeshot/narrowphase/surface_contact.hpp>

namespace grapeshot {

struct LocalContactSettings {
    /// Sine of the angle by which a surface may lean towards the other body and still count as locally closest. Larger:
    /// nearly parallel faces give all their corners at once (stable rest), but slanted directions survive.
    float lean = 0.08F;
    /// Contacts farther apart than this are left out, m. (A corner of a triangle within the distance may be beyond it.)
    float maxDistance = std::numeric_limits<float>::infinity();
};

/// Contacts of `pairs` that are local extrema, each closest feature pair once: corner on face, corner on edge or
/// corner, edge on edge. Corners of nearly parallel triangles are all tried, not only the pair's witness points. The
/// sign follows the outward normals of whichever side is solid: a corner behind the other's surface is a penetration
/// with the depth to it, also where its triangle overlaps the surface, however deep; it must really be inside, with
/// nothing between. Between two sheets all distances are positive. What the corners and crossing edges do not tell of a
/// cut is left to penetration.hpp. Appended to `out` in an order that does not depend on the order of `pairs`; A's
/// frame. Cost: one pass, no work units.
void localContacts(const MeshModel& a, const MeshModel& b, const Pose& bInA, std::span<const TriangleContact> pairs,
                   const LocalContactSettings& settings, std::vector<SurfaceContact>& out);

}  // namespace grapeshot
