// Building and moving models in slices, for whoever may not stop for so long: see core/sliced.hpp. The same bytes as
// makeModelOf and refit.
#pragma once

#include <cstdint>
#include <span>

#include <grapeshot/core/sliced.hpp>
#include <grapeshot/narrowphase/feature_model.hpp>
#include <grapeshot/narrowphase/mesh_model.hpp>

namespace grapeshot {

/// All but `model.tree`, which is there already. About 5 work units a triangle.
Sliced makeModelInSlices(MeshModel& model);

/// What Method::scf needs, if it is not there. About 26 work units a triangle.
Sliced addFeaturesInSlices(MeshModel& model);

/// The same into an empty model of features.
Sliced makeFeatureModelInSlices(const Tree& tree, std::span<const std::uint32_t> leafOf, FeatureModel& model);

/// All of it.
Sliced copyInSlices(const MeshModel& from, MeshModel& to);

/// New vertex positions. Until it is done, or if it throws, the model is of no use.
Sliced refitInSlices(MeshModel& model, std::span<const Eigen::Vector3f> vertices);

}  // namespace grapeshot
