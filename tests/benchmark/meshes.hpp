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

/// What is reported: generated, 1k to 1M triangles, box diagonal 2; `quick` leaves out those beyond 10k.
[[nodiscard]] std::vector<NamedMesh> generatedMeshes(bool quick);

/// The reported ones, or the given files in their place.
[[nodiscard]] std::vector<NamedMesh> reportedMeshes(const std::vector<std::string>& files, bool quick);

/// The file, box diagonal scaled to 2. @throws Error as the importer does
[[nodiscard]] NamedMesh fileMesh(const std::string& file);

}  // namespace grapeshot::bench
