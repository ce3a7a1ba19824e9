#include "scene_method.hpp"

#include <BulletCollision/Gimpact/btGImpactShape.h>

#include <scenes/triangle_arrays.hpp>

#include "decimation.hpp"

namespace grapeshot::bench {

using scenes::Engine;
using scenes::Mesh;

namespace {

SceneMethod plain(std::string name, Engine engine, int runs) {
    SceneMethod method{std::move(name), {}, runs};
    method.world.engine = engine;
    return method;
}

/// A GImpact shape and what it reads.
struct OwnMesh {
    Mesh mesh;
    std::unique_ptr<btTriangleIndexVertexArray> arrays;
    std::unique_ptr<btGImpactMeshShape> shape;
};

}  // namespace

SceneMethod grapeshotMethod(int runs) {
    return plain("grapeshot", Engine::grapeshot, runs);
}

SceneMethod gimpactMethod() {
    return plain("gimpact", Engine::gimpact, 1);
}

SceneMethod hullMethod(int runs) {
    return plain("hull", Engine::hull, runs);
}

SceneMethod hacdMethod(int runs, const HullSettings& settings) {
    SceneMethod method = plain("hacd" + std::to_string(settings.hulls), Engine::none, runs);
    method.world.standIn = [settings](const Mesh& mesh, double margin) { return hullCompound(mesh, settings, margin); };
    return method;
}

SceneMethod decimatedMethod(int runs, std::size_t triangles) {
    SceneMethod method = plain("decimated" + std::to_string(triangles), Engine::grapeshot, runs);
    method.world.standIn = [triangles](const Mesh& mesh, double margin) {
        const auto own = std::make_shared<OwnMesh>();
        own->mesh = decimated(mesh.view(), triangles);
        own->arrays = scenes::arraysOf(own->mesh.view());
        own->shape = std::make_unique<btGImpactMeshShape>(own->arrays.get());
        own->shape->setMargin(static_cast<btScalar>(margin));
        own->shape->updateBound();
        return std::shared_ptr<btCollisionShape>(own, own->shape.get());
    };
    return method;
}

SceneMethod budgeted(SceneMethod method, std::uint64_t work) {
    method.world.settings.frameBudget.work = work;
    return method;
}

SceneMethod halvedRate(SceneMethod method) {
    method.name += "@half";
    method.world.timeStep *= 2;
    return method;
}

SceneMethod roundRobin(int runs, std::uint64_t workOfPair) {
    SceneMethod method = plain("roundRobin", Engine::grapeshot, runs);
    method.world.settings.pairBudget.work = workOfPair;
    return method;
}

}  // namespace grapeshot::bench
