// Models of Bullet's shapes: built when first met, checked for edits once a step, shared by content.
//
// Bullet tells nothing: shapes have no version counter and no sign when they die. So an entry is found by the shape's
// address and believed only after a look at the shape itself; an address that another shape has taken meanwhile gives a
// new model. User pointers of shapes belong to the program.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <unordered_map>
#include <vector>

#include <grapeshot/narrowphase/model_cache.hpp>
#include <grapeshot/plugin/detail/shape_mesh.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

/// A shape's surface at one time. Never changes; edits make a new one.
struct ShapeModel {
    std::shared_ptr<const MeshModel> mesh;  ///< null if it cannot be used
    std::vector<MeshPart> parts;
    std::string error;           ///< why not
    std::uint64_t topology = 0;  ///< the same number: the same triangles, vertices may have moved
};

/// How thoroughly to look for edits.
enum class Check {
    sampled,   ///< 64 vertices and 16 triangles, other ones each time
    thorough,  ///< up to 4096 of each
};

/// What is known of the shape at one address.
class ShapeEntry {
  public:
    /// The shape's model now. Looks at the shape, but only once per `step` if that is not 0.
    std::shared_ptr<const ShapeModel> model(const btCollisionShape& shape, ModelCache& cache, Check check,
                                            std::uint64_t step);
    void notifyChanged();
    /// What is known, without a look at the shape; null: nothing.
    [[nodiscard]] std::shared_ptr<const ShapeModel> present();

  private:
    [[nodiscard]] bool isUnchanged(std::size_t vertices, std::size_t triangles);
    void read(ModelCache& cache);

    std::mutex m_mutex;
    std::vector<PartSource> m_sources;  // of m_model
    std::vector<PartSource> m_found;
    std::shared_ptr<const ShapeModel> m_model;
    std::uint64_t m_checkedStep = 0;
    std::uint64_t m_thoroughStep = 0;
    std::size_t m_cursor = 0;  // where the next sample begins
    bool m_changed = false;
};

/// All entries of the process: a shape may be used in several worlds.
class ShapeModels {
  public:
    static ShapeModels& instance();

    /// Hold it as long as the shape is in use.
    std::shared_ptr<ShapeEntry> entry(const btCollisionShape& shape);
    void notifyChanged(const btCollisionShape& shape);
    /// For drawing: the shape's model if there is one, not checked for edits.
    std::shared_ptr<const ShapeModel> present(const btCollisionShape& shape);
    ModelCache& cache() { return m_cache; }

  private:
    struct Place {
        std::shared_ptr<ShapeEntry> entry;
        std::uint64_t lastUse = 0;
    };
    void dropIdle();
    std::shared_ptr<ShapeEntry> known(const btCollisionShape& shape);

    std::mutex m_mutex;
    std::unordered_map<const btCollisionShape*, Place> m_entries;  // looked up, never walked in its order
    std::uint64_t m_use = 0;
    std::size_t m_limit = 512;
    ModelCache m_cache;
};

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
