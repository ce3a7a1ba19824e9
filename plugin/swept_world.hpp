// Worlds that meet fast links of multibodies in time.
#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionWorld.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>

#include <grapeshot/plugin/precision.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {

namespace detail {
/// After Bullet's own updateAabbs.
void sweepLinkAabbs(btCollisionWorld& world) noexcept;
}  // namespace detail

/// Takes the place of `Base`, a world with multibodies in it, with the same constructors. Bullet's broadphase makes
/// pairs of rigid bodies ahead of time, since their boxes reach to where they will be; those of links (and bases) do
/// not, so a link that is farther from a thin mesh than it flies in a step never meets it, whatever the algorithms do.
/// Here their boxes reach as far as a rigid body's. O(links) a step and joint that carries them.
template <class Base>
class BasicSweptWorld : public Base {
  public:
    using Base::Base;
    void updateAabbs() override {
        Base::updateAabbs();
        detail::sweepLinkAabbs(*this);
    }
};
using SweptMultiBodyWorld = BasicSweptWorld<btMultiBodyDynamicsWorld>;

}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
