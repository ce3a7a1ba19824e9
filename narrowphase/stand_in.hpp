// Contacts for a pair whose search was cut short before it knew what holds the bodies apart: where the trees say that
// the surfaces cross and most likely push. So a body that lands on another is held from the first step, whatever the
// budget.
#pragma once

#include <cstdint>
#include <vector>

#include <grapeshot/core/pose.hpp>
#include <grapeshot/narrowphase/contact_set.hpp>
#include <grapeshot/narrowphase/mesh_model.hpp>
#include <grapeshot/narrowphase/surface_contact.hpp>

namespace grapeshot {

/// Work units that it takes. With fewer, surfaces that are merely near may seem to cross: then it has to be surer.
inline constexpr std::uint64_t standInWork = 8;

/// Appends up to four contacts (A's frame, without triangles: `noTriangle`) if the surfaces more likely cross than not:
/// one of each region that is likelier than not, the likeliest in any case. Their normals are good to some ten degrees;
/// depths are told too large by coarse pieces, so they are held within `mostDepth`, m. Returns the work.
std::uint64_t standInContacts(const MeshModel& a, const MeshModel& b, const Pose& bInA, const RegionSettings& regions,
                              float mostDepth, std::uint64_t work, std::vector<SurfaceContact>& out);

/// Takes such contacts out again.
void dropStandIns(ContactSet& set);

}  // namespace grapeshot
