// A small intestine on its mesentery as one soft body: a tube folded to and fro, and the sheet that it hangs on.
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

namespace grapeshot::intestine {

struct OrganSettings {
    double length = 18;  ///< of the tube along its middle, m: 4 to 60
    int around = 12;     ///< vertices around the tube: even, 6 to 128; triangles grow with its square
};

constexpr double tubeRadius = 0.15;  // m
constexpr double margin = 0.015;     // m

struct Organ {
    std::unique_ptr<btSoftBody> body;  ///< nodes of the mesentery's root are fixed
    int rings = 0;                     ///< ring i of the tube: the nodes [i * around, (i + 1) * around)
    int around = 0;
    std::size_t tubeTriangles = 0;
};

/// The middle of the tube, in the plane of its start, evenly spaced by about `spacing` m.
[[nodiscard]] std::vector<Eigen::Vector3d> coil(double length, double spacing);

/// Deterministic. O(triangles).
[[nodiscard]] Organ makeOrgan(btSoftBodyWorldInfo& info, const OrganSettings& settings);

}  // namespace grapeshot::intestine
