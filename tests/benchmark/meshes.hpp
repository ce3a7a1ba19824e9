// The meshes that the benchmarks report: none of them is used to tune anything.
#pragma once

#include <string>
#include <vector>

#include <scenes/shapes.hpp>

namespace grapeshot::bench {

struct NamedMesh {
    std::string name;
    scenes::Mesh mesh;
};

/// Generated, 1k to 100k triangles, box diagonal 2; `quick` leaves out those beyond 10k.
[[nodiscard]] std::vector<NamedMesh> generatedMeshes(bool quick);

/// The file, box diagonal scaled to 2. @throws Error as the importer does
[[nodiscard]] NamedMesh fileMesh(const std::string& file);

}  // namespace grapeshot::bench
