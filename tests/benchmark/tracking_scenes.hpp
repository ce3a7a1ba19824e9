// Deforming surfaces in contact: where they are, frame by frame.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <grapeshot/scf/tracker.hpp>

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
[[nodiscard]] TrackingFrame twoBodiesAt(const TrackingScene& scene, float depth, float frame, int frames);

/// The same bodies, each turned about its middle, B's beyond A's by `gap` (m) along x.
[[nodiscard]] TrackingFrame twoBodiesTurned(const TrackingScene& scene, const Eigen::Matrix3f& turnA,
                                            const Eigen::Matrix3f& turnB, float gap, float phase);

/// What a step of a tracker is given, beside the scene.
struct TrackingBudget {
    std::uint64_t work = unlimited;
    std::uint32_t frontCells = 64;
    float auditShare = 0.1F;
    float lookAhead = 0;  ///< steps
};
/// Of two bodies of 100k triangles, and of two of a million: chosen on `--scenario meetings --seed 5` to 8.
inline constexpr TrackingBudget bodiesBudget{6'000, 128, 0.5F};
inline constexpr TrackingBudget largeBodiesBudget{7'000, 256, 0.8F};
[[nodiscard]] constexpr TrackingBudget withWork(TrackingBudget budget, std::uint64_t work) {
    budget.work = work;
    return budget;
}

/// m, of the vertex that moved farthest.
[[nodiscard]] float farthestMove(const std::vector<Eigen::Vector3f>& from, const std::vector<Eigen::Vector3f>& to);

[[nodiscard]] TrackSettings settingsOf(const TrackingScene& scene, const TrackingBudget& budget, std::uint64_t seed);

}  // namespace grapeshot::bench
