// What a mesh teaches about itself when its tree is built: how far the calibration is off for it.
#pragma once

#include <grapeshot/adb/calibration.hpp>
#include <grapeshot/adb/tree.hpp>

namespace grapeshot {

/// Sets Tree::stepRates, so that the probabilities after one, two, four and eight steps come true, in sum, over `poses`
/// poses of the mesh against itself (those that certificationPoses draws from, evenly spread, always the same ones),
/// answered exactly. A calibration is right for meshes on the average; bumps and hollows make one mesh collide less
/// often than its rates say, flat sides another one more often. For two trees the geometric mean counts. `build` does
/// this with the default calibration; call it for another one, or after a refit that has changed the shape a lot.
/// Deterministic; the same on every instruction set. Takes about 1 us a pose, and never more than 4,008 units of work
/// (see Budget) for one; poses that need more are left out. Without poses, or if none leaves a doubt, all is as in the
/// calibration.
/// @throws Error badSetting: `poses` outside 0..10000
void tune(Tree& tree, int poses, const Calibration& calibration = defaultCalibration());

}  // namespace grapeshot
