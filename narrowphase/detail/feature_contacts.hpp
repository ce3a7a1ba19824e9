// Is a pair of features of two surfaces a local contact? One pair at a time, exactly; what local_contacts.hpp means.
//
// This work is based on:
// Ming Lin, John Canny. A fast algorithm for incremental distance calculation. ICRA 1991 (Voronoi regions of features)
// Brian Mirtich. V-Clip: Fast and Robust Polyhedral Collision Detection. 1998 (penetrating features)
// Here for non-convex surfaces: local extrema instead of one closest pair, and a tolerance on the sharp features.
#pragma once

#include <cmath>
#include <cstdint>

#include <Eigen/Core>

#include <grapeshot/narrowphase/detail/contact_collector.hpp>
#include <grapeshot/narrowphase/detail/edge_contact.hpp>
#include <grapeshot/narrowphase/detail/extremum.hpp>
#include <grapeshot/narrowphase/detail/mesh_side.hpp>
#include <grapeshot/narrowphase/local_contacts.hpp>

namespace grapeshot::detail {

/// Tests pairs of features of placed triangles and collects the contacts among them. Which triangle a feature is
/// reached by does not matter, nor how often.
class FeatureContacts {
  public:
    FeatureContacts() = default;
    /// Keeps references to all of them.
    FeatureContacts(const MeshSide& a, const MeshSide& b, float rounding, const LocalContactSettings& settings,
                    ContactCollector& collector)
        : m_a(&a),
          m_b(&b),
          m_settings(settings),
          m_collector(&collector),
          m_rounding(rounding),
          m_cosLean(std::cos(coneWidening(settings.lean))),
          m_sinLean(std::sin(coneWidening(settings.lean))) {}

    void cornerBFaceA(const PlacedTriangle& a, const PlacedTriangle& b, unsigned corner) {
        cornerAndFace(*m_b, b, corner, *m_a, a);
    }
    void cornerAFaceB(const PlacedTriangle& a, unsigned corner, const PlacedTriangle& b) {
        cornerAndFace(*m_a, a, corner, *m_b, b);
    }
    void edges(const PlacedTriangle& a, unsigned edgeA, const PlacedTriangle& b, unsigned edgeB);
    void cornerBEdgeA(const PlacedTriangle& a, unsigned edge, const PlacedTriangle& b, unsigned corner) {
        cornerAndEdge(*m_b, b, corner, *m_a, a, edge);
    }
    void cornerAEdgeB(const PlacedTriangle& a, unsigned corner, const PlacedTriangle& b, unsigned edge) {
        cornerAndEdge(*m_a, a, corner, *m_b, b, edge);
    }
    void corners(const PlacedTriangle& a, unsigned cornerA, const PlacedTriangle& b, unsigned cornerB);

    /// Every pair of features of the two triangles: what a filter may not change.
    void everything(const PlacedTriangle& a, const PlacedTriangle& b);

  private:
    struct CornerAndFace;
    struct Rim;

    void cornerAndFace(const MeshSide& cornerSide, const PlacedTriangle& triangle, unsigned corner,
                       const MeshSide& faceSide, const PlacedTriangle& face);
    void cornerOnFace(const CornerAndFace& pair);
    [[nodiscard]] bool counts(const PlacedTriangle& a, const PlacedTriangle& b, float signedDistance) const;
    void cornerBehindGap(const CornerAndFace& pair, unsigned edge);
    [[nodiscard]] bool cornerFaces(const MeshSide& side, std::uint32_t vertex, const Eigen::Vector3f& towards,
                                   float lean) const;
    [[nodiscard]] bool reallyBehind(const CornerAndFace& pair) const;
    [[nodiscard]] bool insideOwnBody(const CornerAndFace& pair, const Eigen::Vector3f& point) const;
    [[nodiscard]] bool reallyCrossed(const SurfaceEdge& onA, const SurfaceEdge& onB,
                                     const SurfaceContact& contact) const;
    void cornerAndEdge(const MeshSide& cornerSide, const PlacedTriangle& triangle, unsigned corner,
                       const MeshSide& edgeSide, const PlacedTriangle& other, unsigned edge);
    void cornerOnRim(const MeshSide& cornerSide, const PlacedTriangle& triangle, unsigned corner, const Rim& rim);
    bool isNew(const MeshSide& cornerSide, std::uint32_t vertex, std::uint64_t other);
    void add(const MeshSide& cornerSide, std::uint32_t vertex, std::uint64_t other, const SurfaceContact& contact);

    const MeshSide* m_a = nullptr;
    const MeshSide* m_b = nullptr;
    LocalContactSettings m_settings;
    ContactCollector* m_collector = nullptr;
    float m_rounding = 0;
    float m_cosLean = 1, m_sinLean = 0;  // of what a corner's cone is widened by
};

}  // namespace grapeshot::detail
