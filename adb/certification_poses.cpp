#include <grapeshot/adb/certification_poses.hpp>

#include <grapeshot/adb/detail/pose_range.hpp>
#include <grapeshot/core/random.hpp>

namespace grapeshot {
namespace {

/// Keeps these draws apart from all others with the same seed: no world counts so many steps.
constexpr std::uint64_t certificationStep = 0xcef71f1ca7eU;

}  // namespace

std::vector<Pose> certificationPoses(const Tree& a, const Tree& b, std::size_t count, std::uint64_t seed) {
    const detail::PoseRange range(a, b);
    std::vector<Pose> poses;
    poses.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
        const RandomKey key{.seed = seed, .pair = i, .step = certificationStep};
        std::array<double, 6> unit{};
        for (std::uint32_t draw = 0; draw < unit.size(); ++draw) {
            unit[draw] = double{randomUnit(key, draw)};
        }
        poses.push_back(range.at(unit));
    }
    return poses;
}

}  // namespace grapeshot
