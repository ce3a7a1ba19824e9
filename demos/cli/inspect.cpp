// `grapeshot inspect FILE`: what a mesh is like, and whether it can be used.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <import/mesh_import.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include <grapeshot/core/error.hpp>
#include <grapeshot/core/mesh_report.hpp>
#include <report/text_file.hpp>

#include "commands.hpp"

namespace grapeshot::cli {
namespace {

struct InspectOptions {
    std::string file;
    std::string jsonFile;
};

nlohmann::ordered_json asJson(const Eigen::Vector3f& v) {
    return {v.x(), v.y(), v.z()};
}

nlohmann::ordered_json asJson(const MeshReport& report, const std::string& file, const std::string& fault) {
    return {{"file", file},
            {"usable", fault.empty()},
            {"fault", fault},
            {"vertices", report.vertices},
            {"triangles", report.triangles},
            {"distinctVertices", report.distinctVertices},
            {"unusedVertices", report.unusedVertices},
            {"notFiniteVertices", report.notFiniteVertices},
            {"indicesOutOfRange", report.indicesOutOfRange},
            {"degenerateTriangles", report.degenerateTriangles},
            {"boundaryEdges", report.boundaryEdges},
            {"nonManifoldEdges", report.nonManifoldEdges},
            {"misorientedEdges", report.misorientedEdges},
            {"pieces", report.pieces},
            {"closed", report.closed},
            {"volume", report.volume},
            {"area", report.area},
            {"lower", asJson(report.lower)},
            {"upper", asJson(report.upper)},
            {"relativePrecision", report.relativePrecision}};
}

std::string faultOf(MeshView mesh) {
    try {
        requireUsable(mesh);
        return "";
    } catch (const Error& error) {
        return error.what();
    }
}

ExitCode inspectFile(const InspectOptions& options) {
    const scenes::Mesh mesh = import::importMesh(options.file);
    const MeshReport report = inspect(mesh.view());
    const std::string fault = faultOf(mesh.view());
    std::printf("%s\n%s", options.file.c_str(), describe(report).c_str());
    std::printf("%s\n", fault.empty() ? "It can be used." : ("It cannot be used: " + fault).c_str());
    if (!options.jsonFile.empty()) {
        report::writeText(options.jsonFile, asJson(report, options.file, fault).dump(2) + "\n");
    }
    return fault.empty() ? done : claimFailed;
}

}  // namespace

void addInspect(CLI::App& tool, std::function<ExitCode()>& run) {
    auto* command =
        tool.add_subcommand("inspect", "What a mesh is like, and whether it can be used (else exit code 1)");
    auto options = std::make_shared<InspectOptions>();
    command->add_option("FILE", options->file, "mesh file: OBJ, STL, PLY, OFF, glTF, Collada, ...")->required();
    command->add_option("--json", options->jsonFile, "also write the report here");
    command->callback([options, &run] { run = [options] { return inspectFile(*options); }; });
}

}  // namespace grapeshot::cli
