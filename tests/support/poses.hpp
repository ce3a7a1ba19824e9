// Seeded relative poses, by the procedures that the reports name.
#pragma once

#include <cstdint>
#include <vector>

#include <grapeshot/adb/tree.hpp>
#include <grapeshot/core/pose.hpp>

namespace grapeshot::test {

/// A small deterministic generator for tests (splitmix64); not the library's.
class Random {
  public:
    explicit Random(std::uint64_t seed) : m_state(seed) {}
    std::uint64_t bits();
    double unit();  ///< [0, 1)
    double uniform(double low, double high);
    Eigen::Vector3f direction();  ///< uniform on the sphere
    Eigen::Matrix3f rotation();   ///< uniform on SO(3)

  private:
    std::uint64_t m_state;
};

/// Uniform rotation, B's centre of box within the inflated box of A.
Pose randomPose(const Tree& a, const Tree& b, Random& random);

struct PoseSet {
    std::vector<Pose> poses;
    std::vector<int> distanceIndex;  ///< of each pose
    std::vector<double> distances;   ///< m
};
/// Each order of the poses alike likely; indices go with them.
void shuffle(PoseSet& set, Random& random);

/// Zachmann's procedure: for each of `distances` centre distances, from nearly always colliding to never, `perDistance`
/// random directions and rotations. Distances run evenly between 0.2 and 1.05 of the mean bounding diameter. Shuffled.
PoseSet zachmannPoses(const Tree& a, const Tree& b, int distances, int perDistance, std::uint64_t seed);

/// Grazing poses: random rotation, B slid along a random direction to first touch of A (bisection with the exact query
/// to 1e-5 of the size), then moved by `gap` times the box diagonal (negative: into A).
std::vector<Pose> grazingPoses(const Tree& a, const Tree& b, int count, double gap, std::uint64_t seed);

}  // namespace grapeshot::test
