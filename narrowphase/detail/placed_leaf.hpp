// The four triangles of a leaf, with what the contact search asks of their surroundings, in A's frame.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include <grapeshot/narrowphase/detail/mesh_side.hpp>

namespace grapeshot::detail {

/// Lanes are the leaf's triangles; unused ones repeat lane 0 and are not `valid`. Edge e runs from corner e to corner
/// e + 1. Masks have a bit per lane.
struct alignas(64) LeafRows {
    float corner[3][3][4];   ///< [corner][axis][lane], m
    float along[3][3][4];    ///< unit, [edge]; zero if the edge is a point
    float outward[3][3][4];  ///< unit, in the triangle's plane, out of it across the edge
    float across[3][3][4];   ///< unit normal of the triangle across; zero without one
    float normal[3][4];      ///< unit, or zero
    float upward[3][3][4];   ///< vertex normals, [corner]; zero where unknown
    float coneCosine[3][4];  ///< of the cone about it that the corner can be touched in (MeshModel::vertexCones)
    float length[3][4];      ///< of the edges, m
    std::uint32_t valid;
    std::uint32_t sharpCorner[3];  ///< not flatCorner: it may be the end of something
    std::uint32_t bent[3];         ///< edges that may touch others (bentEdges)
    std::uint32_t ownCorner[3];    ///< the triangle is the first of those at the corner
    std::uint32_t ownEdge[3];      ///< the same at the edge
    std::uint32_t sharp[3];
    std::uint32_t gap[3];  ///< edges beside which a corner can be behind both faces: concave; of a sheet all
};

struct PlacedLeaf {
    LeafRows rows;
    std::array<PlacedTriangle, 4> triangle;  ///< as MeshSide::place gives them; unused lanes are stale
};

/// Places the leaves of one side as they are asked for, each part of each leaf once.
class LeafPlacer {
  public:
    /// Forgets everything; memory is kept. `lean` as LocalContactSettings::lean.
    void start(const MeshSide& side, float lean);

    [[nodiscard]] const LeafRows& rows(std::uint32_t leaf) {
        Entry& found = entry(leaf);
        if (!found.hasRows) {
            fillRows(leaf, found.leaf.rows);
            found.hasRows = true;
        }
        return found.leaf.rows;
    }
    [[nodiscard]] const std::array<PlacedTriangle, 4>& triangles(std::uint32_t leaf) {
        Entry& found = entry(leaf);
        if (!found.hasTriangles) {
            fillTriangles(leaf, found.leaf.triangle);
            found.hasTriangles = true;
        }
        return found.leaf.triangle;
    }

  private:
    struct Place {
        std::uint32_t epoch = 0;
        std::uint32_t index = 0;
    };
    struct Entry {
        PlacedLeaf leaf;
        bool hasRows = false;
        bool hasTriangles = false;
    };
    static constexpr std::uint32_t chunk = 64;  // entries that stand together: what is handed out stays where it is

    Entry& entry(std::uint32_t leaf) {
        Place& place = m_places[leaf];
        return place.epoch == m_epoch ? at(place.index) : makeEntry(place);
    }
    Entry& at(std::uint32_t index) { return m_chunks[index / chunk][index % chunk]; }
    Entry& makeEntry(Place& place);
    void fillRows(std::uint32_t leaf, LeafRows& rows) const;
    void fillTriangles(std::uint32_t leaf, std::array<PlacedTriangle, 4>& triangles) const;

    MeshSide m_side;
    float m_cosLean = 1, m_sinLean = 0;  // of what a corner's cone is widened by
    std::vector<Place> m_places;         // by leaf
    std::uint32_t m_epoch = 0;
    std::vector<std::vector<Entry>> m_chunks;
    std::uint32_t m_used = 0;
};

}  // namespace grapeshot::detail
