// Sixteen pairs of moving triangles: where they are, and how long they surely stay apart.
//
// This work is based on:
// Brian Mirtich. Impulse-based Dynamic Simulation of Rigid Body Systems. PhD thesis, Berkeley 1996 (conservative
// advancement)
// Min Tang, Young Kim, Dinesh Manocha. C2A: Controlled Conservative Advancement for Continuous Collision Detection of
// Polygonal Models. ICRA 2009 (motion bounded along the direction of the closest points)
#pragma once

#include <cstdint>

#include <grapeshot/core/triangle_batch.hpp>

namespace grapeshot::detail {

/// Corners at both ends of a step in which they go on straight lines.
struct PathBatch {
    TriangleBatch beforeA{}, beforeB{}, nowA{}, nowB{};
};

/// At a moment, relative to A's first corner and its velocity.
struct MovingBatch {
    TriangleBatch a{}, b{};                  ///< m
    TriangleBatch velocityA{}, velocityB{};  ///< m per step
    /// Bound on the acceleration of every corner of A plus that of every one of B, m per step^2; 0 on straight lines.
    alignas(64) float acceleration[batchWidth] = {};
};

/// With the accelerations left alone.
void placeAt(const PathBatch& path, const float (&time)[batchWidth], MovingBatch& out) noexcept;

/// step: so long the triangles surely stay farther apart than `reach`, infinite if for ever; 0 for the lanes that
/// touch. By the planes across the closest points, along both faces and along the closest edges, and by the largest
/// speed, whichever says the most.
/// @param apart what `signedDistances` says of the batch
/// @return the lanes that touch: nearer than reach + tolerance, or 1.5e-6 of the extent if that is more
std::uint32_t advance(const MovingBatch& pairs, const DistanceBatch& apart, float reach, float tolerance,
                      float (&step)[batchWidth]) noexcept;

}  // namespace grapeshot::detail
