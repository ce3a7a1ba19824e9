// Contacts ahead of time: where the motion of the coming step will bring two surfaces together that are still apart.
//
// Bullet stops only convex shapes on their way, with a swept sphere. But its solver takes contacts with a positive
// distance and lets bodies approach by no more than that in a step. So the motion is tried out in steps of half the
// thinner body's thickness. Thick meshes are only asked whether they overlap; thin ones, solids and bodies that overlap
// already, whether there are contacts that are none now (stop_points.hpp: and what keeps the rest of the body back).
// Those of the last moment before are handed over as they are now: apart. What merely lies in the direction of motion
// is no contact, so nothing trips over planes that it flies past.
#pragma once

#include <cstdint>
#include <vector>

#include <grapeshot/plugin/detail/pair_contacts.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

/// What the two may approach each other by in the coming step, m; not finite if that is not known. No work.
[[nodiscard]] float stepApproach(const PairShapes& shapes, const PairTask& task);
/// The same, but no more than the settings' limit, if that is so much that they have to be looked at on the
/// way; else 0. No bounds, no work.
[[nodiscard]] float sweptMotion(const PairShapes& shapes, const PairTask& task);

/// Work units that a pair gets beyond its mandatory slice for that, whatever the budget: half of them and more for the
/// way ahead.
inline constexpr std::uint64_t sweepSlice = 64;

struct Swept {
    std::uint64_t work = 0;
    bool complete = true;  ///< the budget did not end it
};
/// Fills `ahead` (points as they are now, A's and B's frames) if the bodies move fast enough. Not where they touch
/// already: what rolls on a floor needs no contacts with the floor ahead.
Swept sweptContacts(const PairShapes& shapes, const PairTask& task, const PairSettings& settings, const Budget& budget,
                    const ContactSet& now, ContactSet& ahead);

/// Local contacts within `reach` for B at a pose in A's frame; appended to `found`. Returns the work.
std::uint64_t nearContacts(const PairShapes& shapes, const Pose& bInA, float reach, const PairSettings& settings,
                           Budget budget, std::vector<SurfaceContact>& found);

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
