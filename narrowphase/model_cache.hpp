// Models by content: two shapes with the same triangles share one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include <grapeshot/narrowphase/mesh_model.hpp>

namespace grapeshot {

/// 128-bit hash of vertices and triangles (xxHash3), byte for byte.
struct ContentKey {
    std::uint64_t low = 0;
    std::uint64_t high = 0;
    friend bool operator==(const ContentKey&, const ContentKey&) = default;
};
[[nodiscard]] ContentKey contentKey(MeshView mesh) noexcept;

/// Owns built models; safe for use from several threads. A model lives as long as somebody holds it, or while it is
/// among the `idle` most recently used ones.
class ModelCache {
  public:
    explicit ModelCache(std::size_t idle = 64);
    ~ModelCache();
    ModelCache(const ModelCache&) = delete;
    ModelCache& operator=(const ModelCache&) = delete;

    /// The model of this content, built now if need be. Content is compared, not only hashed.
    /// @throws Error as `build` does; the cache is unchanged then.
    std::shared_ptr<const MeshModel> get(MeshView mesh, const BuildSettings& settings = {});

    struct Counts {
        std::uint64_t hits = 0, builds = 0;
        std::size_t held = 0;  ///< models alive by the cache's own knowledge
    };
    [[nodiscard]] Counts counts() const;
    /// Forget idle models.
    void clear();

  private:
    struct State;
    std::unique_ptr<State> m_state;
};

}  // namespace grapeshot
