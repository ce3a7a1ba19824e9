// A small intestine on its mesentery: a tube folded to and fro, and the sheets between its folds that it hangs on. A
// coarse soft body, and the smooth surface that it carries.
//
// This work is based on:
// Laks Raghupathi et al. An Intestinal Surgery Simulator: Real-Time Collision Processing and Visualization. IEEE TVCG
// 10(6), 2004 (the organ, and what is asked of it)
//
// The model is ten times as large as life: lengths in metres are decimetres of the patient.
#pragma once

#include <BulletSoftBody/btSoftBody.h>

#include <Eigen/Core>
#include <memory>
#include <vector>

#include <soft/contact_projection.hpp>

namespace grapeshot::intestine {

struct OrganSettings {
    double length = 30;  ///< of the tube along its middle, m: 4 to 50
    int fineness = 1;    ///< pieces of the surface along each edge of the body that carries it: 1 to 16
};

constexpr double tubeRadius = 0.15;  // m
constexpr double thickness = 0.02;   // m, of two layers in contact
constexpr double rootRadius = 0.7;   // where the mesentery is fixed, m

/// Height of the bowl in which it lies, m.
[[nodiscard]] double groundAt(double x, double z);

struct Organ {
    std::unique_ptr<btSoftBody> core;  ///< nodes of the mesentery's root are fixed
    soft::CarriedSurface surface;
    int rings = 0;  ///< ring i of the tube: the core's nodes [i * around, (i + 1) * around)
    int around = 0;
    int strand = 0;  ///< ring in the middle of an outward strand, as near to the tube's middle as can be
};

/// The middle of the tube, evenly spaced by about `spacing` m.
[[nodiscard]] std::vector<Eigen::Vector3d> coil(double length, double spacing);

/// Deterministic. No two layers are nearer than twice the thickness at the start. O(triangles).
[[nodiscard]] Organ makeOrgan(btSoftBodyWorldInfo& info, const OrganSettings& settings);

}  // namespace grapeshot::intestine
