// The names of bodies in statistics and random keys: those of their broadphase proxies, which are never pointers.
#pragma once

#include <BulletCollision/BroadphaseCollision/btBroadphaseProxy.h>
#include <BulletCollision/CollisionDispatch/btCollisionObject.h>

#include <cstdint>

#include <grapeshot/core/random.hpp>
#include <grapeshot/plugin/precision.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

/// -1 if the body has none.
[[nodiscard]] inline int proxyOf(const btCollisionObject& object) {
    const btBroadphaseProxy* proxy = object.getBroadphaseHandle();
    return proxy != nullptr ? proxy->getUid() : -1;
}

/// The same in either order.
[[nodiscard]] inline std::uint64_t keyOf(const btCollisionObject& first, const btCollisionObject& second) {
    return pairKey(static_cast<std::uint32_t>(proxyOf(first)), static_cast<std::uint32_t>(proxyOf(second)));
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
