// Building and moving models in slices, for whoever may not stop for so long: see core/sliced.hpp. The same bytes as
// makeModelOf and refit.
#pragma once

#include <span>

#include <grapeshot/core/sliced.hpp>
#include <grapeshot/narrowphase/mesh_model.hpp>

namespace grapeshot {

/// All but `model.tree`, which is there already. About 5 work units a triangle.
Sliced makeModelInSlices(MeshModel& model);

/// What Method::scf needs, if it is not there: the ball tree is one piece, which counts as the largest there may be.
Sliced addFeaturesInSlices(MeshModel& model);

/// All of it.
Sliced copyInSlices(const MeshModel& from, MeshModel& to);

/// New vertex positions. Until it is done, or if it throws, the model is of no use.
Sliced refitInSlices(MeshModel& model, std::span<const Eigen::Vector3f> vertices);

}  // namespace grapeshot
