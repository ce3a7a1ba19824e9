// Of pairs of triangles that are near each other the nearest: a fine surface that a coarser body keeps apart needs no
// more.
#pragma once

#include <span>
#include <vector>

#include <grapeshot/plugin/detail/surface_contacts.hpp>
#include <grapeshot/scf/ball_tree.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

/// Pairs within the distance at the end of the step, of a body with itself: of those of two leaves whose closest points
/// have their middle in one cube of the spacing the nearest one, and all that overlap. Ascending, and the same whatever
/// the order of `pairs`.
class ThinPairs {
  public:
    /// @param near see SurfaceContacts::find; pairs with a corner that is near one of the other's are left out
    void find(const BallTree& tree, const SurfaceInStep& body, std::span<const TrianglePair> pairs, float distance,
              float spacing, const IndexLists* near, std::vector<TrianglePair>& thin);

  private:
    struct Candidate {
        std::array<std::int32_t, 5> place{};  // both leaves, the cube
        float distance = 0;
        TrianglePair pair;
    };
    std::vector<TrianglePair> m_within;
    std::vector<Candidate> m_candidates;
};

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
