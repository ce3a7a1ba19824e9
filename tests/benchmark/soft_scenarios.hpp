// The scenes of the suite `soft`: each adds its rows and claims, at the margins that every gate holds at.
#pragma once

#include <report/report.hpp>

#include "options.hpp"

namespace grapeshot::bench {

/// Two soft bodies of so many triangles each: the whole step must be so many times as fast as by Bullet's own handlers.
inline constexpr int softGateTriangles = 70'000;
inline constexpr double softGateRatio = 10;
/// Few, because Bullet's own takes seconds for each.
inline constexpr int gateSteps = 5;

/// A sheet of so many triangles falls on one that is held at its border.
void runSheets(int triangles, const Options& options, report::Report& results);
/// A soft ball of so many triangles, under pressure, falls on another.
void runBalls(int triangles, const Options& options, report::Report& results);
/// Cloth falls on a torus mesh. @param ring its radius, m; all other lengths are multiples of it
void runClothOnTorus(double ring, const Options& options, report::Report& results);
/// Cloth whose one half lies above the other falls on the ground. @param triangles 512: folded sharply, as it is hard
/// for the solver; more: round
void runFold(int triangles, const Options& options, report::Report& results);
/// The scenes of Bullet's own demos, both soft worlds: does anything break, and who is inside of what?
void runSoftDemos(const Options& options, report::Report& results);
/// Rigid meshes shot at a sheet that is held at its border: who goes through.
void runSoftShots(const Options& options, report::Report& results);

}  // namespace grapeshot::bench
