// What a program may choose. The defaults are meant for games at 60 Hz with bodies of any size.
#pragma once

#include <cstdint>

#include <grapeshot/core/budget.hpp>
#include <grapeshot/narrowphase/mesh_model.hpp>
#include <grapeshot/narrowphase/method.hpp>
#include <grapeshot/plugin/precision.hpp>

class btCollisionObject;

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {

/// Lengths that are given as shares are multiples of the pair's size: half the diagonal of the box around the smaller
/// of its two bodies. So one setting serves pebbles and ships.
struct Settings {
    /// How contacts of mesh pairs are found; see there. A mesh under scf has both trees, for depths, bodies in bodies
    /// and what is ahead of fast ones ask adb's: about 5 us and 110 bytes a triangle more, built in slices (see
    /// prebuild).
    Method method = Method::automatic;
    /// Method::scf: work units of a step that may go into finding where two meshes are near; half of it is enough for
    /// most pairs of a pile, and then nothing is left out. What takes more is tracked and sampled: such answers are not
    /// certain (see PairStatistics::missBound). Larger: fewer of these; smaller: cheaper steps where bodies are
    /// tangled, and contacts that are found a step late.
    std::uint64_t searchWork = 4096;
    /// Solid: of two closed meshes one inside the other collides. Surface: only where the surfaces meet; a body inside
    /// a hollow one is free.
    Interior interior = Interior::solid;
    /// Most work (in calls of a 16-wide kernel, about 0.2 us each) or time that a pair may cost in one step.
    /// What is cut short keeps its contacts of the last step and goes on in the next. Time gives up reproducibility.
    Budget pairBudget = {};
    /// Of a Dispatcher: most work (or time) that all pairs of a step may cost together, split by importance. Every pair
    /// gets its mandatory slice: 8 units; 24 (by scf 96) if it was cut short or has no contacts, and 64 more if it has
    /// none and may pass through within the step. Meshes against planes and convex shapes are pairs like others. What
    /// cannot be cut short: soft bodies that move by more in a step than their margins, or half an edge if more. So a
    /// step costs at most max(budget, sum of these); children of compounds and further dispatches that the last step
    /// had not may add their slices to that. 5,000 units are about a millisecond. Unlimited by default: then the
    /// contacts are those of registerAlgorithms alone. With a time, every pair gets its slice first, whatever that
    /// takes.
    Budget frameBudget = {};
    /// Of a Dispatcher: threads that compute contacts, 1..256. The contacts are the same for any number.
    int threads = 1;
    /// Of a Dispatcher: what a pair counts for beside its motion, mass and size, relative to others; > 0. Called once a
    /// step for each pair, from the thread that steps the world. Null: 1.
    float (*pairWeight)(const btCollisionObject&, const btCollisionObject&) noexcept = nullptr;
    /// The same for one pair of a query: contactTest, contactPairTest.
    Budget queryBudget = {};
    /// Of everything random: the samples of Method::scf.
    std::uint64_t seed = 1;
    /// Most contact manifolds (of four points each) of a pair: 1..16. More: the solver works longer; fewer: bodies that
    /// touch in many places rock. The shallowest are left out.
    int maxManifolds = 8;
    /// Contacts this near to each other that face the same way share a manifold, as a share of the pair's size: > 0, at
    /// most 10. Larger: fewer points; smaller: more.
    float contactSpacing = 0.25F;
    /// A contact this near to one of the last step is the same one, as a share of the pair's size: > 0, at most 1. Too
    /// small: contacts lose their impulses while bodies slide; too large: points pile up.
    float mergeDistance = 0.02F;
    /// While two bodies have moved against each other by less than this share of the pair's size, the trees are not
    /// traversed anew: >= 0, at most 1. The contacts are the same. Larger: fewer traversals, more triangle tests. Of
    /// use where it is more than what `reuse` lets them move.
    float slack = 0.01F;
    /// While two meshes have moved against each other by less than this share of the contact breaking threshold since
    /// their contacts were last searched for, the known ones are only brought up to date: 0..0.9. What comes nearer
    /// meanwhile is found before its margins touch: contacts are searched for as far beyond the margins as bodies get
    /// by this or in one step, and kept up to the breaking threshold. Larger: fewer searches; smaller: cheaper ones,
    /// and contacts follow rolling and rocking more closely. 0: a search in every step.
    float reuse = 0.75F;
    /// Sine of the angle by which a surface may lean towards the other and still touch with all its corners:
    /// 0..0.5. See LocalContactSettings::lean.
    float lean = 0.08F;
    /// Contacts ahead of time for pairs that move against each other by more than half their thickness in one step, so
    /// that they do not pass through each other. Costs some further queries for such pairs alone.
    bool speculative = true;
    /// Motion of one step beyond this is not looked at, m: >= 0, infinity allowed.
    float speculativeLimit = 10.0F;
    /// GImpact meshes against planes and convex shapes too, and GImpact compounds against whatever there is. Off: those
    /// pairs keep the algorithm they had.
    bool convexPairs = true;
    /// All other meshes against convex shapes too (BVH, scaled, multi-material, height fields). Off: Bullet's own,
    /// which tests each triangle alone: bodies bump into the inner edges of flat ground, and Bullet 3.24 drops contacts
    /// of what lies below a triangle's plane.
    bool bvhConvexPairs = false;
    /// Soft bodies (cloth, ropes, tetrahedra) against meshes and against each other, where the dispatcher's
    /// configuration knows soft bodies. Meshes: bodies with the collision flag SDF_RS or SDF_RD. Each other: both with
    /// VF_SS. Of btDeformableMultiBodyDynamicsWorld (both with SDF_RD): with VF_DD alone they stay Bullet's; with VF_SS
    /// and VF_DD they are ours, and Bullet, which asks all pairs of bodies there whatever the dispatcher does, does
    /// nothing about them; with VF_SS alone it makes contacts that nobody reads, which costs time. Clusters, and what
    /// else they are flagged for, stay with Bullet. Contacts are of
    /// corners with faces and of edges with edges, with true normals, on the side that each came from, and ahead of
    /// time. Off: Bullet's own, for which every triangle is a slab of 12 cm.
    bool softPairs = true;

    /// Nothing is left out: no budgets, nothing sampled, most manifolds, a search in every step.
    [[nodiscard]] static Settings exact() noexcept;
};

/// Are all fields within their ranges?
[[nodiscard]] bool isValid(const Settings& settings) noexcept;

}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
