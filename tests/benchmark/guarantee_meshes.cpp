#include "guarantee_meshes.hpp"

namespace grapeshot::bench {

std::vector<NamedMesh> guaranteeMeshes(bool quick) {
    std::vector<NamedMesh> meshes;
    const auto add = [&](const char* name, scenes::Mesh mesh) {
        if (!quick || mesh.triangles.size() <= 15'000) {
            meshes.push_back({name, scenes::normalised(std::move(mesh))});
        }
    };
    add("bumpySphere", scenes::bumpySphere(1.0F, 0.3F, 4, 24, 313));
    add("bumpySphereFine", scenes::bumpySphere(1.0F, 0.18F, 8, 58, 911));
    add("cinquefoil", scenes::torusKnot(2, 5, 1.0F, 0.38F, 0.16F, 500, 24));
    add("knot3x4", scenes::torusKnot(3, 4, 1.0F, 0.45F, 0.11F, 900, 28));
    add("spikedBall", scenes::spikedBall(1.0F, 0.3F, 60, 30'000));
    add("gear", scenes::gear(1.0F, 0.18F, 0.25F, 0.22F, 24, 3));
    add("cup", scenes::cup(0.6F, 0.12F, 1.6F, 120, 60));
    add("chainShot", scenes::chainShot(1.0F, 0.18F, 220, 40));
    add("archBlock", scenes::archBlock({1.0F, 0.7F, 0.35F}, 0.45F, 32, 4));
    add("crossPlug", scenes::crossPlug(1.0F, 0.35F, 1.2F, 12));
    add("comb", scenes::comb(7, 0.9F, 0.22F, 0.2F, 6));
    add("torus", scenes::torus(1.0F, 0.22F, 260, 64));
    add("plate", scenes::plateWithCrossHole(1.0F, 0.15F, 0.55F, 0.25F, 0.03F, 8));
    return meshes;
}

}  // namespace grapeshot::bench
