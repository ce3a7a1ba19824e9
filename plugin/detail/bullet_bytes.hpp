// Bullet's vectors as bytes, in the build's precision.
#pragma once

#include <LinearMath/btTransform.h>

#include <grapeshot/core/bytes.hpp>
#include <grapeshot/plugin/precision.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

inline void put(ByteWriter& out, const btVector3& v) {
    for (int i = 0; i < 3; ++i) {
        out.put(v[i]);
    }
}
inline void put(ByteWriter& out, const btTransform& transform) {
    for (int row = 0; row < 3; ++row) {
        put(out, transform.getBasis()[row]);
    }
    put(out, transform.getOrigin());
}

[[nodiscard]] inline btVector3 getVector(ByteReader& in) {
    btVector3 v(0, 0, 0);
    for (int i = 0; i < 3; ++i) {
        v[i] = in.get<btScalar>();
    }
    return v;
}
[[nodiscard]] inline btTransform getTransform(ByteReader& in) {
    btTransform transform;
    for (int row = 0; row < 3; ++row) {
        transform.getBasis()[row] = getVector(in);
    }
    transform.setOrigin(getVector(in));
    return transform;
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
