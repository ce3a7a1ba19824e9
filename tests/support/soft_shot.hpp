// A rigid mesh shot at a soft body: where from, how fast, for how long.
#pragma once

#include <LinearMath/btTransform.h>

#include <cstdint>

#include <grapeshot/core/random.hpp>

namespace grapeshot::test {

struct SoftShot {
    btTransform from = btTransform::getIdentity();
    btVector3 velocity{0, 0, 0};  ///< m/s
    btScalar speed = 0;           ///< down, m/s
    int steps = 0;                ///< until it has hit and settled
};

/// 1 to 30 m/s downwards, a little aslant, from half a metre and more above the middle, turned anyhow.
[[nodiscard]] inline SoftShot softShot(std::uint64_t seed, std::uint64_t number) {
    std::uint32_t drawn = 0;
    const auto draw = [&](double from, double to) {
        return btScalar(from + (to - from) * static_cast<double>(randomUnit({seed, number, 0}, drawn++)));
    };
    SoftShot shot;
    shot.speed = draw(1, 30);
    const btScalar x = draw(-0.5, 0.5);
    const btScalar y = draw(0.5, 1.5);
    const btScalar z = draw(-0.5, 0.5);
    const btScalar turnX = draw(-1, 1);
    const btScalar turnY = draw(-1, 1);
    shot.from = btTransform(btQuaternion(turnX, turnY, draw(-1, 1), btScalar(1.5)).normalized(), {x, y, z});
    const btScalar aslant = draw(-0.1, 0.1);
    shot.velocity = shot.speed * btVector3(aslant, -1, draw(-0.1, 0.1));
    shot.steps = static_cast<int>(150 / static_cast<double>(shot.speed)) + 60;
    return shot;
}

}  // namespace grapeshot::test
