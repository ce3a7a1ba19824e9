#include "scene_reader.hpp"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/DefaultLogger.hpp>
#include <assimp/Importer.hpp>
#include <assimp/LogStream.hpp>
#include <optional>
#include <string_view>
#include <vector>

namespace grapeshot::import::detail {
namespace {

/// Some loaders meet a bad index or a short file, say so in the log, and go on with an invented value. Those lines.
class InventionLog : public Assimp::LogStream {
  public:
    explicit InventionLog(std::optional<WireError>& found) : m_found(found) {}
    void write(const char* message) override {
        const std::string_view text(message);
        if (m_found) {
            return;
        }
        if (text.find("ndex") != std::string_view::npos && text.find("out of range") != std::string_view::npos) {
            m_found = {Fault::indexOutOfRange, std::string(text)};
        } else if (text.find("header is incorrect") != std::string_view::npos) {
            m_found = {Fault::badFile, std::string(text)};
        }
    }

  private:
    std::optional<WireError>& m_found;
};

/// Faces as loaded, before assimp's own steps, which believe them.
std::optional<WireError> checkFaces(const aiScene& scene) {
    for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
        const aiMesh& mesh = *scene.mMeshes[m];
        const auto place = [&](unsigned f) { return "face " + std::to_string(f) + " of mesh " + std::to_string(m); };
        for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
            const aiFace& face = mesh.mFaces[f];
            if (face.mNumIndices == 0) {
                return WireError{Fault::badFile, place(f) + " has no corners"};
            }
            for (unsigned c = 0; c < face.mNumIndices; ++c) {
                if (face.mIndices[c] >= mesh.mNumVertices) {
                    return WireError{Fault::indexOutOfRange, place(f) + " names vertex " +
                                                                 std::to_string(face.mIndices[c]) + " of " +
                                                                 std::to_string(mesh.mNumVertices)};
                }
            }
        }
    }
    return std::nullopt;
}

/// Appends one mesh, moved. A mirroring transform turns the surface inside out: its triangles are turned back.
void append(const aiMesh& mesh, const aiMatrix4x4t<double>& toRoot, scenes::Mesh& out) {
    const auto base = static_cast<std::uint32_t>(out.vertices.size());
    for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
        const aiVector3D& p = mesh.mVertices[v];
        const aiVector3t<double> moved = toRoot * aiVector3t<double>(p.x, p.y, p.z);
        out.vertices.emplace_back(static_cast<float>(moved.x), static_cast<float>(moved.y),
                                  static_cast<float>(moved.z));
    }
    const bool mirrored = toRoot.Determinant() < 0;
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
        if (mesh.mFaces[f].mNumIndices != 3) {
            continue;
        }
        const unsigned* corner = mesh.mFaces[f].mIndices;
        out.triangles.push_back({base + corner[0], base + corner[mirrored ? 2 : 1], base + corner[mirrored ? 1 : 2]});
    }
}

std::variant<scenes::Mesh, WireError> flatten(const aiScene& scene, std::size_t maxVertices, std::size_t maxTriangles) {
    struct Pending {
        const aiNode* node;
        aiMatrix4x4t<double> toRoot;
    };
    scenes::Mesh out;
    std::vector<Pending> pending{{scene.mRootNode, {}}};  // a stack of our own: files nest as deep as they like
    while (!pending.empty()) {
        const auto [node, parentToRoot] = pending.back();
        pending.pop_back();
        const aiMatrix4x4t<double> toRoot = parentToRoot * aiMatrix4x4t<double>(node->mTransformation);
        for (unsigned m = 0; m < node->mNumMeshes; ++m) {
            const aiMesh& mesh = *scene.mMeshes[node->mMeshes[m]];
            if ((mesh.mPrimitiveTypes & aiPrimitiveType_TRIANGLE) ==
                0) {  // beside it may stand a mark of former polygons
                continue;
            }
            if (out.vertices.size() + mesh.mNumVertices > maxVertices ||
                out.triangles.size() + mesh.mNumFaces > maxTriangles) {
                return WireError{Fault::limitExceeded, "more than " + std::to_string(maxVertices) + " vertices or " +
                                                           std::to_string(maxTriangles) + " triangles"};
            }
            append(mesh, toRoot, out);
        }
        for (unsigned c = node->mNumChildren; c-- > 0;) {
            if (node->mChildren[c] == nullptr) {  // assimp 5.2 on RAW files with several objects
                return WireError{Fault::badFile, "the loader lost a part of it"};
            }
            pending.push_back({node->mChildren[c], toRoot});
        }
    }
    return out;
}

}  // namespace

std::variant<scenes::Mesh, WireError> readScene(const std::string& file, std::size_t maxVertices,
                                                std::size_t maxTriangles) {
    std::optional<WireError> invented;
    Assimp::DefaultLogger::create("", Assimp::Logger::NORMAL, 0);
    Assimp::DefaultLogger::get()->attachStream(new InventionLog(invented), Assimp::Logger::Err);  // the logger owns it

    Assimp::Importer importer;
    importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
    const aiScene* scene = importer.ReadFile(file, 0);
    if (invented) {
        return *invented;
    }
    if (scene == nullptr || scene->mRootNode == nullptr) {
        return WireError{Fault::badFile, importer.GetErrorString()};
    }
    if (scene->mNumMeshes == 0) {
        return WireError{Fault::emptyMesh, "no surface in the file"};
    }
    if (std::optional<WireError> bad = checkFaces(*scene)) {
        return *bad;
    }
    // Nothing more of assimp: PreTransformVertices crashes on some valid files, FindInvalidData drops meshes silently.
    scene = importer.ApplyPostProcessing(aiProcess_Triangulate | aiProcess_SortByPType);
    if (scene == nullptr) {
        return WireError{Fault::emptyMesh, "no triangles in the file"};
    }
    std::variant<scenes::Mesh, WireError> result = flatten(*scene, maxVertices, maxTriangles);
    const auto* mesh = std::get_if<scenes::Mesh>(&result);
    if (mesh != nullptr && mesh->triangles.empty()) {
        return WireError{Fault::emptyMesh, "no triangles in the file"};
    }
    return result;
}

}  // namespace grapeshot::import::detail
