// Models by content: two shapes with the same triangles share one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include <grapeshot/core/content_key.hpp>
#include <grapeshot/core/sliced.hpp>
#include <grapeshot/narrowphase/mesh_model.hpp>

namespace grapeshot {

/// Owns built models; safe for use from several threads. A model lives as long as somebody holds it, or while it is
/// among the `idle` most recently used ones.
class ModelCache {
  public:
    /// @param folder where trees are kept on disk (see tree_file.hpp); made when first needed. Empty: nowhere.
    explicit ModelCache(std::size_t idle = 64, std::filesystem::path folder = {});
    ~ModelCache();
    ModelCache(const ModelCache&) = delete;
    ModelCache& operator=(const ModelCache&) = delete;

    /// The model of this content, built now if need be. Content is compared, not only hashed. Models with and without
    /// `features` (see MeshModel) are different ones.
    /// @throws Error as `build` does; the cache is unchanged then.
    std::shared_ptr<const MeshModel> get(MeshView mesh, const BuildSettings& settings = {.tuningPoses = 0},
                                         bool features = false);

    /// The same in slices; `model` is set when it is done. What two of them want at once is built twice, and shared
    /// afterwards. Reading and writing a file is one piece, which counts as one unit.
    Sliced getInSlices(MeshView mesh, BuildSettings settings, std::shared_ptr<const MeshModel>& model,
                       bool features = false);

    /// From now on trees are kept there. Empty: nowhere.
    void setFolder(std::filesystem::path folder);

    struct Counts {
        std::uint64_t hits = 0, builds = 0;
        std::uint64_t loads = 0;     ///< of these builds, trees that came from the disk
        std::uint64_t badFiles = 0;  ///< that were ignored, or could not be written; built anew
        std::size_t held = 0;        ///< models alive by the cache's own knowledge
    };
    [[nodiscard]] Counts counts() const;
    /// Of the last bad file, in words; empty if there was none.
    [[nodiscard]] std::string lastWarning() const;
    /// Forget idle models.
    void clear();

  private:
    struct State;
    std::unique_ptr<State> m_state;
};

}  // namespace grapeshot
