// A wrapper in place of its body's in a result, while a part of the body is looked at.
#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>

#include <grapeshot/plugin/precision.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

/// For as long as it lives.
class WrapInPlace {
  public:
    WrapInPlace(btManifoldResult& result, const btCollisionObjectWrapper& wrap, bool isFirst)
        : m_result(result), m_before(isFirst ? result.getBody0Wrap() : result.getBody1Wrap()), m_isFirst(isFirst) {
        set(&wrap);
    }
    ~WrapInPlace() { set(m_before); }
    WrapInPlace(const WrapInPlace&) = delete;
    WrapInPlace& operator=(const WrapInPlace&) = delete;

  private:
    void set(const btCollisionObjectWrapper* wrap) {
        m_isFirst ? m_result.setBody0Wrap(wrap) : m_result.setBody1Wrap(wrap);
    }
    btManifoldResult& m_result;
    const btCollisionObjectWrapper* m_before;
    bool m_isFirst;
};

/// The same for a child of a compound, whose index the result then names.
class ChildInPlace {
  public:
    ChildInPlace(btManifoldResult& result, const btCollisionObjectWrapper& child)
        : m_wrap(result, child, isFirst(result, child)) {
        isFirst(result, child) ? result.setShapeIdentifiersA(-1, child.m_index)
                               : result.setShapeIdentifiersB(-1, child.m_index);
    }

  private:
    static bool isFirst(const btManifoldResult& result, const btCollisionObjectWrapper& child) {
        return result.getBody0Internal() == child.getCollisionObject();
    }
    WrapInPlace m_wrap;
};

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
