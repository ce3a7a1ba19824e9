#include "meshes.hpp"

#include <filesystem>

#include <import/mesh_import.hpp>

namespace grapeshot::bench {

std::vector<NamedMesh> generatedMeshes(bool quick) {
    std::vector<NamedMesh> meshes;
    const auto add = [&](const char* name, scenes::Mesh mesh) {
        if (!quick || mesh.triangles.size() <= 10'000) {
            meshes.push_back({name, scenes::normalised(std::move(mesh))});
        }
    };
    add("bumpySphere", scenes::bumpySphere(1.0F, 0.22F, 9, 8, 6151));
    add("cup", scenes::cup(0.7F, 0.09F, 1.3F, 44, 14));
    add("chainShot", scenes::chainShot(1.0F, 0.22F, 48, 24));
    add("gear", scenes::gear(1.0F, 0.14F, 0.31F, 0.37F, 19, 4));
    add("torusKnot", scenes::torusKnot(3, 5, 1.0F, 0.42F, 0.13F, 460, 20));
    add("spikedBall", scenes::spikedBall(1.0F, 0.38F, 46, 42'000));
    add("bumpySphereFine", scenes::bumpySphere(1.0F, 0.27F, 13, 70, 24593));
    add("gearFine", scenes::gear(1.0F, 0.22F, 0.5F, 0.6F, 13, 21));
    add("torusKnotFine", scenes::torusKnot(2, 5, 1.0F, 0.35F, 0.16F, 5'200, 96));
    return meshes;
}

std::vector<NamedMesh> reportedMeshes(const std::vector<std::string>& files, bool quick) {
    if (files.empty()) {
        return generatedMeshes(quick);
    }
    std::vector<NamedMesh> meshes;
    for (const std::string& file : files) {
        meshes.push_back(fileMesh(file));
    }
    return meshes;
}

NamedMesh fileMesh(const std::string& file) {
    return {std::filesystem::path(file).stem().string(), scenes::normalised(import::importMesh(file))};
}

}  // namespace grapeshot::bench
