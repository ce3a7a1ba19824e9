// The scenes of the suite `stochastic`: two bodies from apart to deep in contact. Written down before anything was
// measured on them; not changed since.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include <scenes/shapes.hpp>

namespace grapeshot::bench {

/// A vertex at rest and the step, to where it is in the body's own frame.
using Deformation = Eigen::Vector3f (*)(const Eigen::Vector3f& rest, float step);

/// B comes straight at A, turning; both may deform. The boxes' diagonals are 2 m at rest.
struct ApproachScene {
    std::string name;
    scenes::Mesh a, b;
    float speed = 0.01F;  ///< of B towards A's middle, m per step
    float spin = 0;       ///< of B, rad per step
    Deformation deformA = nullptr;
    Deformation deformB = nullptr;
};

struct Placement {
    std::vector<Eigen::Vector3f> a, b;  ///< in one frame, m
};

/// An episode is a random attitude of both, a random direction of approach and a random axis of the spin.
[[nodiscard]] Placement place(const ApproachScene& scene, std::uint64_t episode, int step);

/// Steps after which B has passed A's middle.
[[nodiscard]] int lastStep(const ApproachScene& scene);

/// The five that are reported:
/// bumpyBalls: two smooth lobed balls, rigid, slow spin.
/// gearOnKnot: a gear and the tube along a (3, 5) knot, rigid, spinning by a degree per step.
/// spikesInCup: a spiked ball whose spikes swell and shrink by 6 %, against a cup.
/// clothOnRings: an open sheet in travelling waves against two linked rings.
/// writhingKnots: two (2, 5) knots that bend like eels.
[[nodiscard]] std::vector<ApproachScene> reportedApproaches();

/// Others, on which budget, depth and distance were chosen: other shapes, other seeds.
[[nodiscard]] std::vector<ApproachScene> fittingApproaches();

}  // namespace grapeshot::bench
