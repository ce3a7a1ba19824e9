// Deforming surfaces in contact: where they are, frame by frame.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <scenes/shapes.hpp>

namespace grapeshot::bench {

/// Of one surface with itself if `b` is empty.
struct TrackingScene {
    std::string name;
    scenes::Mesh a, b;      ///< at rest
    float maxDistance = 0;  ///< m
    float spacing = 0;      ///< m
    float exclusion = 0;    ///< m
    [[nodiscard]] bool isSelf() const { return b.triangles.empty(); }
};

/// Positions of both surfaces in a frame, counted from 0.
struct TrackingFrame {
    std::vector<Eigen::Vector3f> a, b;
};

/// Two bumpy spheres of about so many triangles that wave, approach, touch and go past each other within `frames`
/// frames; box diagonal 2.
[[nodiscard]] TrackingScene twoBodies(const std::string& name, int frequency, std::uint32_t seed);
/// @param depth m, by how much their distance shrinks to the middle of the time; 0.08 is a light contact
[[nodiscard]] TrackingFrame twoBodiesAt(const TrackingScene& scene, float depth, int frame, int frames);

/// The same bodies, each turned about its middle, B's beyond A's by `gap` (m) along x.
[[nodiscard]] TrackingFrame twoBodiesTurned(const TrackingScene& scene, const Eigen::Matrix3f& turnA,
                                            const Eigen::Matrix3f& turnB, float gap, float phase);

/// A tube of radius 0.02 m, straight at rest, wound up so that its turns touch; neighbouring turns sway against each
/// other. About `triangles` triangles.
[[nodiscard]] TrackingScene coil(const std::string& name, std::size_t triangles);
[[nodiscard]] TrackingFrame coilAt(const TrackingScene& scene, int frame);
inline constexpr float coilTubeRadius = 0.02F;

}  // namespace grapeshot::bench
