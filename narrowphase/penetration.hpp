// Contacts from the curve in which two surfaces cut through each other, for penetrations deeper than the search
// distance.
#pragma once

#include <span>
#include <vector>

#include <grapeshot/adb/query.hpp>
#include <grapeshot/narrowphase/mesh_model.hpp>
#include <grapeshot/narrowphase/surface_contact.hpp>

namespace grapeshot {

struct PenetrationSettings {
    /// Intersecting pairs belong to one cut if they follow each other on the curve, or if their middles are within this
    /// distance, m.
    float spacing = 0.1F;
    /// A cut whose surroundings (this far, m) already have a penetrating contact is explained and gives none.
    float explainedWithin = 0.1F;
    /// Most contacts per cut, 1..4.
    int maxContacts = 4;
};

/// The overlapping ones of `pairs` are grouped into cuts. The direction of a cut is the area vector of the surface
/// patch that its curve bounds, 1/2 * sum of x cross dx, each segment directed by nA x nB: the gradient of the common
/// volume under translation. Its depth is how far A's inside vertices lie under B's surface along that direction and
/// B's under A's (ray casts), at least the overlap of the two crossing triangles. `already`: the step's local contacts.
/// Appended to `out`, A's frame, signedDistance < 0.
void penetrationContacts(const MeshModel& a, const MeshModel& b, const Pose& bInA,
                         std::span<const TriangleContact> pairs, std::span<const SurfaceContact> already,
                         const PenetrationSettings& settings, std::vector<SurfaceContact>& out);

/// If one solid is wholly inside the other (no surface contact): one contact per contained body, by the shortest way
/// out of a vertex of it. Appended to `out`.
void containmentContacts(const MeshModel& a, const MeshModel& b, const Pose& bInA, std::vector<SurfaceContact>& out);

}  // namespace grapeshot
