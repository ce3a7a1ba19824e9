// Meshes by formula: closed, outward-oriented unless said otherwise, any number of triangles.
#pragma once

#include <cstdint>
#include <vector>

#include <grapeshot/core/mesh_view.hpp>

namespace grapeshot::scenes {

struct Mesh {
    std::vector<Eigen::Vector3f> vertices;
    std::vector<Triangle> triangles;
    [[nodiscard]] MeshView view() const { return {vertices, triangles}; }
};

/// Each face of the box is a grid of `cells` x `cells` x 2 triangles.
Mesh box(const Eigen::Vector3f& half, int cells = 1);
/// Each edge of an icosahedron cut in `frequency`: 20 * frequency^2 triangles, corners on the sphere.
Mesh sphere(float radius, int frequency);
/// About +y; `around` x `across` x 2 triangles.
Mesh torus(float ringRadius, float tubeRadius, int around, int across);
/// Open at +y: outer radius, wall, height; the floor is as thick as the wall. Non-convex, closed surface.
Mesh cup(float radius, float wall, float height, int around, int along);
/// Ball with `spikes` cones of `spikeLength`; about `triangles` triangles, more where the cones need them.
Mesh spikedBall(float radius, float spikeLength, int spikes, int triangles);
/// Two rings through each other, as one mesh of two pieces (a rigid chain shot).
Mesh chainShot(float ringRadius, float tubeRadius, int around, int across);
/// One ring of it, to be linked with a second body.
Mesh ring(float ringRadius, float tubeRadius, int around, int across);
/// A block with `teeth` battlements along x; the half extents are of the whole, the teeth its upper quarter.
/// From here on `cells` cuts every interval of the shape's own grid.
Mesh crenelBlock(const Eigen::Vector3f& half, int teeth, int cells = 1);
/// A block with a half-round arch, open below, cut through along z.
Mesh archBlock(const Eigen::Vector3f& half, float archRadius, int segments, int cells = 1);
/// An upside-down U: two legs, open below. For "U on a bar".
Mesh uBody(float width, float legLength, float thickness, float depth, int cells = 1);
/// A plus-shaped prism along y (`arm` from the middle, `thickness` across), and a plate with a plus-shaped hole for a
/// plug of `arm` and `holeThickness`, wider by `clearance` on each side.
Mesh crossPlug(float arm, float thickness, float height, int cells = 1);
Mesh plateWithCrossHole(float half, float thickness, float arm, float holeThickness, float clearance, int cells = 1);
/// A sphere with smooth lobes: non-convex everywhere, a stand-in for scanned bodies; 20 * frequency^2 triangles.
Mesh bumpySphere(float radius, float amplitude, int lobes, int frequency, std::uint32_t seed = 1);
/// The tube along the (p, q) torus knot.
Mesh torusKnot(int p, int q, float ringRadius, float knotRadius, float tubeRadius, int along, int across);
/// A spur gear, teeth along the rim, with a hole.
Mesh gear(float radius, float toothHeight, float holeRadius, float thickness, int teeth, int cells = 1);
/// A comb: a bar with `teeth` prisms, half a pitch wide, hanging down.
Mesh comb(int teeth, float toothLength, float pitch, float thickness, int cells = 1);
/// A rounded thread about +y: the radius at an angle and a height is radius + depth * cos(2 pi y / pitch - angle).
struct Thread {
    float radius, depth, pitch;
};
/// Flat at both ends. A depth of 0 makes a cylinder. around x (2 along + 2) triangles.
Mesh threadedRod(const Thread& thread, float length, int around, int along);
/// A hexagonal nut for that rod, wider by `clearance` along the radius; `around` is a multiple of 6.
Mesh threadedNut(const Thread& thread, float clearance, float acrossFlats, float height, int around, int along);
/// A stone of an arch about the z axis whose middle is up: from -angle / 2 to angle / 2, between both radii.
Mesh voussoir(float innerRadius, float outerRadius, float angle, float depth, int cells = 1);

/// An open grid in the xz plane, normals +y.
Mesh grid(float halfX, float halfZ, int cellsX, int cellsZ);

/// Both meshes in one, `second` moved by `offset`.
Mesh merged(const Mesh& first, const Mesh& second, const Eigen::Vector3f& offset = Eigen::Vector3f::Zero());
Mesh moved(Mesh mesh, const Eigen::Vector3f& offset);
Mesh scaled(Mesh mesh, float factor);
/// Each vertex moved inwards by `depth`, m, along the mean normal of the triangles around it (by area).
Mesh inwardCopy(const Mesh& mesh, float depth);
/// Centre of the box to the origin, diagonal of the box to `diagonal`.
Mesh normalised(Mesh mesh, float diagonal = 2.0F);

}  // namespace grapeshot::scenes
