// Which triangles of a surface on its way come near those of one that stands still: by boxes, without stretch bounds
// and without memory of other steps. For meshes that are small or far from most of the surface.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include <grapeshot/core/triangle_pair.hpp>
#include <grapeshot/scf/ball_tree.hpp>
#include <grapeshot/scf/box_tree.hpp>

namespace grapeshot {

/// A value, but for the trees, which must stay where they are.
class BoxPairs {
  public:
    /// @param still at rest in its frame
    BoxPairs(const BallTree& moving, const BallTree& still);

    /// Replaces `pairs` by all that come within the distance of each other and some that do not, each once, A of the
    /// moving surface. Its vertices go on straight lines from one moment to the next, in the frame of the other. Empty
    /// if a position is no number. O(vertices), and what is near. Returns the units of work.
    /// @param moments at least one, each with as many positions as the moving tree has vertices; asserted
    std::uint64_t find(std::span<const std::span<const Eigen::Vector3f>> moments, float distance,
                       std::vector<TrianglePair>& pairs);

  private:
    const BallTree* m_moving;
    const BallTree* m_still;
    BoxTree m_boxes;  // of what stands still
    PlainBox m_whole;
};

}  // namespace grapeshot
