// This work is based on:
// Guy Steele, Doug Lea, Christine Flood. Fast Splittable Pseudorandom Number Generators. OOPSLA 2014 (splitmix64)
// Gabriel Zachmann. Rapid Collision Detection by Dynamically Aligned DOP-Trees. VRAIS 1998 (two copies, distances)
#include <support/poses.hpp>

#include <algorithm>

#include <grapeshot/adb/detail/pose_range.hpp>
#include <grapeshot/adb/query.hpp>

namespace grapeshot::test {
namespace {

/// B's middle of box at the given place of A's frame.
Pose placed(const Tree& b, const Eigen::Matrix3f& rotation, const Eigen::Vector3d& place) {
    return {rotation, (place - rotation.cast<double>() * detail::middleOf(b)).cast<float>()};
}

}  // namespace

std::uint64_t Random::bits() {
    m_state += 0x9e3779b97f4a7c15U;
    std::uint64_t z = m_state;
    z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
    return z ^ (z >> 31U);
}

double Random::unit() {
    return static_cast<double>(bits() >> 11U) * 0x1p-53;
}

double Random::uniform(double low, double high) {
    return low + (high - low) * unit();
}

Eigen::Vector3f Random::direction() {
    const double u = unit();
    return detail::directionFrom(u, unit()).cast<float>();
}

Eigen::Matrix3f Random::rotation() {
    const double u = unit();
    const double v = unit();
    return detail::rotationFrom(u, v, unit()).cast<float>();
}

Pose randomPose(const Tree& a, const Tree& b, Random& random) {
    const Eigen::Matrix3f rotation = random.rotation();
    const double margin = 0.25 * (b.upper - b.lower).cast<double>().norm();
    Eigen::Vector3d place;
    for (int axis = 0; axis < 3; ++axis) {
        place[axis] = random.uniform(a.lower[axis] - margin, a.upper[axis] + margin);
    }
    return placed(b, rotation, place);
}

void shuffle(PoseSet& set, Random& random) {
    for (std::size_t i = set.poses.size(); i > 1; --i) {
        const std::size_t j = random.bits() % i;
        std::swap(set.poses[i - 1], set.poses[j]);
        std::swap(set.distanceIndex[i - 1], set.distanceIndex[j]);
    }
}

PoseSet zachmannPoses(const Tree& a, const Tree& b, int distances, int perDistance, std::uint64_t seed) {
    PoseSet set;
    Random random(seed);
    const double diameter = 0.5 * (detail::boundingDiameter(a) + detail::boundingDiameter(b));
    for (int i = 0; i < distances; ++i) {
        const double share = distances > 1 ? static_cast<double>(i) / (distances - 1) : 0;
        set.distances.push_back((0.2 + share * (1.05 - 0.2)) * diameter);
        for (int j = 0; j < perDistance; ++j) {
            const Eigen::Matrix3f rotation = random.rotation();
            const Eigen::Vector3d offset = set.distances.back() * random.direction().cast<double>();
            set.poses.push_back(placed(b, rotation, detail::middleOf(a) + offset));
            set.distanceIndex.push_back(i);
        }
    }
    shuffle(set, random);
    return set;
}

std::vector<Pose> grazingPoses(const Tree& a, const Tree& b, int count, double gap, std::uint64_t seed) {
    std::vector<Pose> poses;
    Random random(seed);
    Query query(a, b);
    const double size = 0.5 * ((a.upper - a.lower).norm() + (b.upper - b.lower).norm());
    const double far = 0.55 * (detail::boundingDiameter(a) + detail::boundingDiameter(b));
    constexpr int steps = 64;
    // A direction along which the bodies never touch (through a hole) is drawn anew.
    for (int attempt = 0; attempt < 100 * count && static_cast<int>(poses.size()) < count; ++attempt) {
        const Eigen::Matrix3f rotation = random.rotation();
        const Eigen::Vector3d direction = random.direction().cast<double>();
        const auto at = [&](double distance) {
            return placed(b, rotation, detail::middleOf(a) + distance * direction);
        };
        double clear = far;
        double touching = -1;
        for (int step = 1; step <= steps; ++step) {
            const double distance = far * (1 - static_cast<double>(step) / steps);
            if (query.decide(at(distance), DecideSettings::exact()).collides) {
                touching = distance;
                break;
            }
            clear = distance;
        }
        if (touching < 0) {
            continue;
        }
        while (clear - touching > 1e-5 * size) {
            const double middle = 0.5 * (clear + touching);
            (query.decide(at(middle), DecideSettings::exact()).collides ? touching : clear) = middle;
        }
        poses.push_back(at(clear + gap * size));
    }
    return poses;
}

}  // namespace grapeshot::test
