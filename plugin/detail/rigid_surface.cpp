#include <grapeshot/plugin/detail/rigid_surface.hpp>

#include <mutex>
#include <unordered_map>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

std::shared_ptr<const RigidSurface> rigidSurfaceOf(const std::shared_ptr<const ShapeModel>& model) {
    static std::mutex& mutex = *new std::mutex;
    static auto& known = *new std::unordered_map<const MeshModel*, std::weak_ptr<const RigidSurface>>;
    const std::lock_guard lock(mutex);
    std::weak_ptr<const RigidSurface>& place = known[model->mesh.get()];
    std::shared_ptr<const RigidSurface> surface = place.lock();
    if (surface == nullptr) {
        std::erase_if(known,
                      [&](const auto& other) { return other.first != model->mesh.get() && other.second.expired(); });
        auto made = std::make_shared<RigidSurface>();
        const MeshModel& mesh = *model->mesh;
        made->tree = buildBallTree({mesh.tree.vertices, mesh.tree.triangles});
        made->owners = ownersOf(mesh.tree.triangles, mesh.tree.vertices.size());
        made->solid = mesh.solid;
        made->model = model;  // so that nothing else takes its address
        surface = made;
        known[model->mesh.get()] = surface;
    }
    return surface;
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
