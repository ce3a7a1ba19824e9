// Models of Bullet's shapes: built when first met, checked for edits once a step, shared by content.
//
// Bullet tells nothing: shapes have no version counter and no sign when they die. So an entry is found by the shape's
// address and believed only after a look at the shape itself; an address that another shape has taken meanwhile gives a
// new model. User pointers of shapes belong to the program.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
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
    /// The shape's own model is being built; this is a sample of it (sampled_mesh.hpp), or what it was before an edit.
    bool isStandIn = false;
};

/// How thoroughly to look for edits.
enum class Check {
    sampled,   ///< 64 vertices and 16 triangles, other ones each time
    thorough,  ///< up to 4096 of each
};

/// When a model is built that is not there.
enum class Pace {
    atOnce,
    inSlices,  ///< as far as `goOnBuilding` goes; a stand-in until it is done. Small meshes: at once
    beside,    ///< at once, but what others build in slices is left to them
};

/// What is known of the shape at one address.
class ShapeEntry {
  public:
    /// The shape's model now. Looks at the shape, but only once per `step` if that is not 0. Adds to `work` (units)
    /// what is built at once, if the pace is inSlices.
    /// @param features with what Method::scf needs, from now on; a stand-in has it not
    std::shared_ptr<const ShapeModel> model(const btCollisionShape& shape, ModelCache& cache, Check check,
                                            std::uint64_t step, Pace pace, std::uint64_t& work, bool features = false);
    std::shared_ptr<const ShapeModel> model(const btCollisionShape& shape, ModelCache& cache, Check check,
                                            std::uint64_t step, bool features = false) {
        std::uint64_t work = 0;
        return model(shape, cache, check, step, Pace::atOnce, work, features);
    }
    void notifyChanged();
    /// Nobody holds it: until the next look another shape may take the address, whose tree must not depend on this one.
    void letGo();
    /// What is known, without a look at the shape; null: nothing.
    [[nodiscard]] std::shared_ptr<const ShapeModel> present();

    [[nodiscard]] bool isBuilding() const;
    /// Goes on; only while the shape is alive, after `model` has looked at it in this step. Returns the work.
    std::uint64_t goOnBuilding(const Budget& budget);

  private:
    /// One model on its way.
    struct Building {
        std::vector<PartSource> sources;
        ShapeMesh mesh;
        std::shared_ptr<const ShapeModel> old;  ///< with the same triangles, perhaps
        std::shared_ptr<ShapeModel> made = std::make_shared<ShapeModel>();
        std::optional<Sliced> work;
    };
    Sliced build(Building& building, ModelCache& cache, bool features);
    void finish();
    void fail(const std::string& error);
    std::shared_ptr<const ShapeModel> standIn(bool edited, std::uint64_t& work) const;
    void beginAnew();
    /// Is the shape still what was read of it, as far as that goes? Looks at so many of its vertices and triangles.
    [[nodiscard]] bool isUnchanged(std::span<const Eigen::Vector3f> readVertices,
                                   std::span<const Triangle> readTriangles, std::size_t vertices,
                                   std::size_t triangles);
    void read(ModelCache& cache, Pace pace, bool edited, std::uint64_t& work);

    mutable std::mutex m_mutex;
    std::unique_ptr<Building> m_building;
    std::vector<PartSource> m_sources;  // of m_model or m_building
    std::vector<PartSource> m_found;
    std::shared_ptr<const ShapeModel> m_model;
    std::uint64_t m_checkedStep = 0;
    std::uint64_t m_thoroughStep = 0;
    std::size_t m_cursor = 0;  // where the next sample begins
    bool m_features = false;   // somebody has asked for them
    bool m_changed = false;
    bool m_letGo = false;
};

/// All entries of the process: a shape may be used in several worlds.
class ShapeModels {
  public:
    static ShapeModels& instance();

    /// Hold it as long as the shape is in use.
    std::shared_ptr<ShapeEntry> entry(const btCollisionShape& shape);
    void notifyChanged(const btCollisionShape& shape);
    /// The shape's model if there is one, not checked for edits. What nobody holds may be another shape's that was at
    /// the address.
    std::shared_ptr<const ShapeModel> present(const btCollisionShape& shape, bool onlyIfHeld = false);
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
