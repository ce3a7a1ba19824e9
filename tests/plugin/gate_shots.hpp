// Thin walls and what is shot at them.
#pragma once

#include <cstdint>

#include <grapeshot/core/random.hpp>

#include "bullet_fixture.hpp"

namespace grapeshot::test {

inline constexpr btScalar shotMargin = 0.005_s;
inline constexpr double halfWall = 0.02;

/// A wall of 4 cm in the yz plane, 4 m x 4 m, with a window of 1 m x 1 m in it if wanted.
inline scenes::Mesh wallMesh(bool window) {
    if (!window) {
        return scenes::box({static_cast<float>(halfWall), 2, 2}, 4);
    }
    const auto bar = [](float y, float z, float halfY, float halfZ) {
        return scenes::moved(scenes::box({static_cast<float>(halfWall), halfY, halfZ}, 2), {0, y, z});
    };
    scenes::Mesh frame = scenes::merged(bar(1.25F, 0, 0.75F, 2), bar(-1.25F, 0, 0.75F, 2));
    frame = scenes::merged(frame, bar(0, 1.25F, 0.5F, 0.75F));
    return scenes::merged(frame, bar(0, -1.25F, 0.5F, 0.75F));
}

/// Uniform numbers, one after the other.
class ShotRandom {
  public:
    explicit ShotRandom(std::uint64_t seed) : m_key{seed, 0, 0} {}
    btScalar uniform(double from, double to) {
        return btScalar(from + (to - from) * static_cast<double>(randomUnit(m_key, m_draw++)));
    }

  private:
    RandomKey m_key;
    std::uint32_t m_draw = 0;
};

inline btQuaternion anyTurn(ShotRandom& random) {
    const btScalar x = random.uniform(-1, 1);
    const btScalar y = random.uniform(-1, 1);
    return btQuaternion(x, y, random.uniform(-1, 1), 1.5_s).normalized();
}

struct Bullets {
    MeshShape plate{scenes::box({0.01F, 0.2F, 0.2F}, 2), Kind::mesh, shotMargin};
    MeshShape box{scenes::box({0.15F, 0.15F, 0.15F}, 2), Kind::mesh, shotMargin};
};

}  // namespace grapeshot::test
