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

Status prebuild(const btCollisionShape* shape, Method method) noexcept {
    if (shape == nullptr) {
        return Status::nullPointer;
    }
    if (!detail::isMesh(*shape)) {
        return Status::unsupportedShape;
    }
    try {
        detail::ShapeModels& models = detail::ShapeModels::instance();
        const auto model =
            models.entry(*shape)->model(*shape, models.cache(), detail::Check::thorough, 0, method == Method::scf);
        return model->mesh ? Status::ok : Status::unusableMesh;
    } catch (...) {
        return Status::outOfMemory;
    }
}

Status keepTrees(const char* folder) noexcept {
    if (folder == nullptr) {
        return Status::nullPointer;
    }
    try {
        detail::ShapeModels::instance().cache().setFolder(folder);
        return Status::ok;
    } catch (...) {
        return Status::outOfMemory;
    }
}

TreeCounts treeCounts() noexcept {
    try {
        const ModelCache& cache = detail::ShapeModels::instance().cache();
        const ModelCache::Counts counts = cache.counts();
        return {counts.builds, counts.loads, counts.badFiles, cache.lastWarning()};
    } catch (...) {
        return {};
    }
}

}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
