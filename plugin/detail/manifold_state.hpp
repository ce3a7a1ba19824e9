// One of our manifolds, with the impulses of its points.
#pragma once

#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include <array>

#include <grapeshot/plugin/detail/bullet_bytes.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

struct ManifoldState {
    int place = 0;  ///< in the dispatcher's list, which is the order in which the solver meets it
    std::uint32_t slot = 0;
    bool ahead = false;
    btScalar breaking = 0;   ///< threshold as Bullet made it, m
    btScalar threshold = 0;  ///< as it is, m
    int count = 0;
    std::array<btManifoldPoint, MANIFOLD_CACHE_SIZE> points;  ///< without the program's pointers
};

void copyPoints(const btPersistentManifold& manifold, ManifoldState& state);
void setPoints(const ManifoldState& state, btPersistentManifold& manifold);

void save(const ManifoldState& state, ByteWriter& out);
/// @throws Error badFile
[[nodiscard]] ManifoldState loadManifoldState(ByteReader& in);

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
