// A rigid mesh as soft bodies meet it.
#pragma once

#include <memory>

#include <grapeshot/plugin/detail/feature_owners.hpp>
#include <grapeshot/plugin/detail/shape_models.hpp>
#include <grapeshot/scf/ball_tree.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

struct RigidSurface {
    BallTree tree;
    FeatureOwners owners;
    bool solid = false;
    std::shared_ptr<const ShapeModel> model;  ///< that it was made of
};

/// Of a model with a mesh; shared by all that ask as long as one of them holds it. Built when first asked for, some 5
/// us a triangle. @throws Error as buildBallTree does
[[nodiscard]] std::shared_ptr<const RigidSurface> rigidSurfaceOf(const std::shared_ptr<const ShapeModel>& model);

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
