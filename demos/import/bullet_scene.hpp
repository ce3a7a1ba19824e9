// A .bullet file as a running world.
//
// Debian's importer is built without GImpact: bodies with such shapes are dropped. Here they are restored, and so are
// velocities, damping and inertia, which Bullet's importer leaves out or works out anew (to zero for moving BVH
// meshes).
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <vector>

#include <scenes/engine.hpp>

namespace grapeshot::import {

struct BulletSceneSummary {
    int bodies = 0;
    int moving = 0;
    int gimpactShapes = 0;  ///< restored
    int meshShapes = 0;     ///< triangle meshes of all kinds
    int droppedBodies = 0;  ///< with shapes that nobody restores
    int constraints = 0;
};

/// All bytes of a file. @throws Error badFile (missing, unreadable), limitExceeded (beyond 1 GiB)
[[nodiscard]] std::vector<std::byte> readBulletFile(const std::filesystem::path& file);

/// Owns the world and what was loaded into it.
class BulletScene {
  public:
    /// Checks the file (checkBulletFile), lets a child process load it first, and only then loads it here: what makes
    /// Bullet's loader crash or run away ends there.
    /// @throws Error badFile, indexOutOfRange, limitExceeded, and badSetting if the library refuses the settings
    BulletScene(const std::filesystem::path& file, scenes::Engine engine, const Settings& settings = {});
    ~BulletScene();
    BulletScene(const BulletScene&) = delete;
    BulletScene& operator=(const BulletScene&) = delete;

    [[nodiscard]] btDiscreteDynamicsWorld& world();
    [[nodiscard]] scenes::TimedDispatcher& dispatcher();
    [[nodiscard]] const BulletSceneSummary& summary() const;

  private:
    struct State;
    std::unique_ptr<State> m_state;
};

/// Writes the world with Bullet's own serializer. @throws Error badFile: cannot be written
void writeBulletFile(btDiscreteDynamicsWorld& world, const std::filesystem::path& file);

}  // namespace grapeshot::import
