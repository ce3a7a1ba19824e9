// Which triangles of a surface come near each other within a step: from a list that is kept, and mended where the
// surface has moved.
//
// Each leaf of the ball tree has a picture of itself from when it was last looked at, and a reach. As long as all of
// its vertices are within the reach of where they are in the picture, nothing new can have come near it. What has gone
// farther has a new picture taken and is searched anew, by itself. So a step costs one look at every vertex, and what
// moves costs a search; what lies still, falls asleep or trembles costs nothing more, and nothing is missed.
//
// This work is based on:
// Loup Verlet. Computer "Experiments" on Classical Fluids. Physical Review 159, 1967 (the list and its skin)
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <grapeshot/core/error.hpp>
#include <grapeshot/core/triangle_pair.hpp>
#include <grapeshot/scf/ball_tree.hpp>
#include <grapeshot/scf/box_tree.hpp>

namespace grapeshot {

struct NeighbourSettings {
    float distance = 0;  ///< m, >= 0
    /// m, > 0: what leaves may move before they are searched anew; each has half of it, beside its way in the step.
    /// More: fewer searches, a longer list.
    float slack = 0;
    float exclusion = 0;  ///< m, >= 0: see TrackSettings
};

struct NeighbourResult {
    /// All that come within the distance of each other, and some that do not: triangleA < triangleB, each once, in an
    /// order that depends on the steps before.
    std::vector<TrianglePair> pairs;
    std::uint64_t work = 0;      ///< units
    std::uint32_t searched = 0;  ///< leaves that had gone too far
    /// badSetting, notFinite, topologyChanged (another number of vertices): nothing is listed then.
    std::optional<Fault> fault;
};

/// Of a body with itself. A value, but for the tree, which must stay where it is.
class NeighbourList {
  public:
    explicit NeighbourList(const BallTree& body) : m_tree(&body) {}

    /// Vertices go on straight lines from `last` to `before` and on to `after`, all in one frame, as many as the tree
    /// has. Other settings than in the call before: everything is searched anew. O(vertices), and some 2 us for each
    /// leaf that is searched.
    void find(std::span<const Eigen::Vector3f> last, std::span<const Eigen::Vector3f> before,
              std::span<const Eigen::Vector3f> after, const NeighbourSettings& settings, NeighbourResult& result);

  private:
    /// Pairs of a leaf with another one, in m_found.
    struct Group {
        std::uint32_t other = 0, look = 0;  // the other's m_looks then
        std::uint32_t begin = 0, end = 0;
    };
    struct Found {
        std::vector<Group> groups;
        std::vector<TrianglePair> pairs;
    };

    void listMoved(std::span<const Eigen::Vector3f> last, std::span<const Eigen::Vector3f> before,
                   std::span<const Eigen::Vector3f> after, const NeighbourSettings& settings);
    void picture(std::uint32_t leaf, float reach);
    std::uint64_t search(std::uint32_t leaf, const NeighbourSettings& settings);
    std::uint64_t compare(std::uint32_t leaf, std::uint32_t other, const NeighbourSettings& settings);

    const BallTree* m_tree;
    NeighbourSettings m_settings;
    std::vector<Eigen::Vector4f> m_now;       // per vertex: where it is, and how far it strays in the step
    std::vector<Eigen::Vector3f> m_pictures;  // per entry of leafVertices
    std::vector<std::uint32_t> m_looks;       // per leaf: how often it was searched
    BoxTree m_boxes;                          // of the pictures
    std::vector<Found> m_found;               // per leaf
    std::vector<std::uint32_t> m_moved;       // ascending
    std::vector<char> m_isMoved;
};

}  // namespace grapeshot
