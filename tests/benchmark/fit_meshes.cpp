#include "fit_meshes.hpp"

namespace grapeshot::bench {

std::vector<NamedMesh> fitMeshes(bool quick) {
    std::vector<NamedMesh> meshes;
    const auto add = [&](const char* name, scenes::Mesh mesh) {
        if (!quick || mesh.triangles.size() <= 10'000) {
            meshes.push_back({name, scenes::normalised(std::move(mesh))});
        }
    };
    add("torus", scenes::torus(1.0F, 0.35F, 96, 48));
    add("trefoil", scenes::torusKnot(2, 3, 1.0F, 0.4F, 0.2F, 300, 24));
    add("bumpySphere", scenes::bumpySphere(1.0F, 0.35F, 5, 40, 77));
    add("spikedBall", scenes::spikedBall(1.0F, 0.6F, 20, 12'000));
    add("comb", scenes::comb(9, 0.6F, 0.16F, 0.09F, 3));
    add("crenelBlock", scenes::crenelBlock({1.0F, 0.5F, 0.4F}, 5, 8));
    add("uBody", scenes::uBody(1.0F, 0.8F, 0.25F, 0.4F, 6));
    add("cup", scenes::cup(0.9F, 0.2F, 0.8F, 90, 30));
    add("bumpySphereFine", scenes::bumpySphere(1.0F, 0.2F, 7, 90, 4001));
    add("trefoilFine", scenes::torusKnot(2, 3, 1.0F, 0.45F, 0.15F, 1200, 60));
    return meshes;
}

}  // namespace grapeshot::bench
