// Contacts between two edges of surfaces.
#pragma once

#include <Eigen/Core>

#include <grapeshot/narrowphase/surface_contact.hpp>

namespace grapeshot::detail {

/// An edge with its two faces; all edges of a pair in one frame.
struct SurfaceEdge {
    Eigen::Vector3f from, to;
    Eigen::Vector3f own;     ///< unit normal of the face left of from -> to; zero if unknown
    Eigen::Vector3f across;  ///< unit normal of the face to its right; zero on a boundary
    bool sharp = false;      ///< nearly parallel faces may end here; otherwise only an exact extremum counts
    bool solid = false;      ///< the normals point out of a solid

    /// Inside a flat face: no end of anything.
    [[nodiscard]] bool flat() const { return (own - across).squaredNorm() < 4e-8F; }
};

struct EdgeContacts {
    int count = 0;
    SurfaceContact contact[2];  ///< without triangles
};

/// Where the edges cross, seen along their common normal (one contact), or the ends of their overlap if they are
/// parallel (two), if both are locally extremal there. Faces of sharp edges that are parallel within 0.02 rad lend
/// their mean normal. A negative distance needs two solids and is only local: whether the bodies really overlap there
/// is for the caller to find out. `lean` as in LocalContactSettings; `rounding` is the error of coordinates, m.
[[nodiscard]] EdgeContacts edgeContacts(const SurfaceEdge& a, const SurfaceEdge& b, float lean, float rounding);

}  // namespace grapeshot::detail
