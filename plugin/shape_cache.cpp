#include <grapeshot/plugin/shape_cache.hpp>

#include <BulletCollision/CollisionShapes/btCollisionShape.h>

#include <grapeshot/plugin/detail/shape_kind.hpp>
#include <grapeshot/plugin/detail/shape_models.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {

void notifyChanged(const btCollisionShape* shape) noexcept {
    if (shape == nullptr) {
        return;
    }
    try {
        detail::ShapeModels::instance().notifyChanged(*shape);
    } catch (...) {
        // Nothing known of the shape: it is read when it is met.
    }
}

Status prebuild(const btCollisionShape* shape) noexcept {
    if (shape == nullptr) {
        return Status::nullPointer;
    }
    if (!detail::isMesh(*shape)) {
        return Status::unsupportedShape;
    }
    try {
        detail::ShapeModels& models = detail::ShapeModels::instance();
        const auto model = models.entry(*shape)->model(*shape, models.cache(), detail::Check::thorough, 0);
        return model->mesh ? Status::ok : Status::unusableMesh;
    } catch (...) {
        return Status::outOfMemory;
    }
}

}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
