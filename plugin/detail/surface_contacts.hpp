// The contacts of two moving surfaces, feature by feature, from pairs of triangles that come near each other in a step:
// corners against faces, edges against edges, each on the side that it came from.
//
// A sheet has no inside. So the side is kept from the past: as long as nothing passes through anything the side is
// where a feature is; what has passed in spite of its contact (bodies are soft, solvers iterate little) remembers the
// face it passed, and starts each further step from the side it belongs to until it is back there.
//
// This work is based on:
// Robert Bridson, Ronald Fedkiw, John Anderson. Robust Treatment of Collisions, Contact and Friction for Cloth
// Animation. SIGGRAPH 2002
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include <grapeshot/core/mesh_view.hpp>
#include <grapeshot/core/triangle_pair.hpp>
#include <grapeshot/plugin/detail/feature_owners.hpp>
#include <grapeshot/scf/facing.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

/// One of the two in a step, everything in one frame.
struct SurfaceInStep {
    std::span<const Eigen::Vector3f> last;    ///< at the begin of the step before, m
    std::span<const Eigen::Vector3f> before;  ///< at the begin of this step
    std::span<const Eigen::Vector3f> after;   ///< where it would go without contacts
    std::span<const Triangle> triangles;
    const FeatureOwners* owners = nullptr;
    const Surface* surface = nullptr;  ///< neighbours
    bool rigid = false;
    bool solid = false;   ///< closed, normals outward: what is inside belongs outside
    bool thread = false;  ///< a rope: the first edge of each triangle counts, and no face
};

enum class Features : std::uint8_t { cornerFace, faceCorner, edges };

struct SoftSurfaceContact {
    std::array<std::uint32_t, 3> a{}, b{};  ///< vertices
    Eigen::Vector3f weightsA = Eigen::Vector3f::Zero(), weightsB = Eigen::Vector3f::Zero();
    Eigen::Vector3f normal = Eigen::Vector3f::Zero();  ///< unit, on B pointing to A
    float before = 0,
          after = 0;  ///< signed distance along the normal at both ends of the step, m; margins not included
    Features features = Features::cornerFace;
    bool crossing = false;  ///< it would pass through, or has
    TrianglePair pair;
};

/// What corners of both face at the end of the step.
struct Faced {
    std::span<const FacingPlace> ofA, ofB;
    bool edges = true;  ///< false: corners alone keep the distance, as they can if no edge is much longer
};

/// A value; kept from step to step for one pair of bodies, or one body with itself.
class SurfaceContacts {
  public:
    /// Appends what would be nearer than `distance` at the end of the step. @param pairs may repeat themselves; what is
    /// not among them is not found. @param near of a body with itself (`a` and `b` the same): the vertices that each
    /// vertex is too near to on the surface to collide with; else null. @param faced null: what corners face is among
    /// the pairs, too
    void find(const SurfaceInStep& a, const SurfaceInStep& b, std::span<const TrianglePair> pairs, double distance,
              const IndexLists* near, std::vector<SoftSurfaceContact>& contacts, const Faced* faced = nullptr);
    void clear();
    /// Corners and pairs of edges that are on the wrong side.
    [[nodiscard]] std::size_t misplaced() const;

  private:
    class Pass;
    /// Where a corner has passed through a face.
    struct Anchor {
        std::uint32_t own = 0;  ///< a triangle at the corner
        std::uint32_t face = 0;
        Eigen::Vector3d weights = Eigen::Vector3d::Zero();
        bool front = true;  ///< it belongs on the side that the face's normal points to
        double time = 2;
    };
    using EdgePair = std::array<std::uint32_t, 4>;  // the first edge's ends, the second's

    std::array<std::map<std::uint32_t, Anchor>, 2> m_anchors;  // corners of a, of b
    struct Passed {
        bool along = true;  ///< the first belongs where first x second points to
        TrianglePair pair;
    };
    std::map<EdgePair, Passed> m_edges;
};

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
