// The closest features of two convex polyhedra, followed from pose to pose.
//
// This work is based on:
// Ming Lin, John Canny. A Fast Algorithm for Incremental Distance Calculation. ICRA 1991
// Brian Mirtich. V-Clip: Fast and Robust Polyhedral Collision Detection. ACM Transactions on Graphics 17(3), 1998
#pragma once

#include <Eigen/Core>

#include <grapeshot/core/pose.hpp>
#include <grapeshot/scf/reference/convex_polyhedron.hpp>

namespace grapeshot::scf::reference {

enum class Outcome {
    closest,      ///< each point lies in the Voronoi region of the other's feature: proven closest
    penetrating,  ///< an edge through a face, a touching pair, or a point behind every face of the other body
    gaveUp,       ///< more steps than `mostSteps`: the features are the last ones seen. Never observed
};

struct ClosestFeatures {
    Outcome outcome = Outcome::gaveUp;
    Feature a, b;
    double distance = 0;       ///< m; 0 if penetrating
    Eigen::Vector3d onA, onB;  ///< witness points in A's frame; if penetrating, where that was seen
    int steps = 0;             ///< pairs of features looked at
    int stuck = 0;             ///< times a point was behind the very face whose prism it is in
};

struct LinCannySettings {
    /// From the last answer's features on (the paper), or from the first vertex of each body every time.
    bool coherent = true;
    /// >= 0; 0: eight times the faces of both bodies, and 64.
    int mostSteps = 0;
};

/// A value that can be copied; keeps references to the bodies.
class LinCanny {
  public:
    /// @throws Error badSetting
    LinCanny(const ConvexPolyhedron& a, const ConvexPolyhedron& b, const LinCannySettings& settings = {});

    /// One step costs the distance of two features and the planes around both; a stuck one looks at all faces of a
    /// body. @throws Error notFinite, notRigid
    ClosestFeatures closest(const Pose& bInA);

    /// Where the next query starts. @throws Error indexOutOfRange
    void startAt(const Feature& a, const Feature& b);

  private:
    const ConvexPolyhedron* m_a;
    const ConvexPolyhedron* m_b;
    LinCannySettings m_settings;
    Feature m_lastA, m_lastB;
};

}  // namespace grapeshot::scf::reference
