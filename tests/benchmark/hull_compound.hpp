// What Bullet's users are told to do with moving concave meshes: a compound of convex hulls.
#pragma once

#include <btBulletDynamicsCommon.h>

#include <memory>

#include <scenes/shapes.hpp>

namespace grapeshot::bench {

struct HullSettings {
    int hulls = 16;
    /// Edges are collapsed to about so many first, as usual before a decomposition: it takes a second then, and minutes
    /// for some meshes of 5,000.
    std::size_t triangles = 1000;
    bool operator==(const HullSettings&) const = default;
};

/// Hierarchical approximate convex decomposition, of Bullet's extras, down to so many hulls of at most 64 vertices. The
/// last few meshes are remembered.
[[nodiscard]] std::shared_ptr<btCollisionShape> hullCompound(const scenes::Mesh& mesh, const HullSettings& settings,
                                                             double margin);

}  // namespace grapeshot::bench
