// A ball against a mesh: also the ends of a capsule and the corners of a box.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include <grapeshot/narrowphase/convex_contacts.hpp>
#include <grapeshot/narrowphase/detail/contact_collector.hpp>
#include <grapeshot/narrowphase/search_region.hpp>

namespace grapeshot::detail {

/// The triangles of some leaf blocks of a mesh; memory is kept.
class Candidates {
  public:
    /// From here on only of the chosen leaves, which are paid for; null: of all.
    void confineTo(LeafChoice* choice) { m_choice = choice; }
    [[nodiscard]] LeafChoice* choice() const { return m_choice; }
    void inBox(const MeshModel& mesh, const Eigen::Vector3f& lower, const Eigen::Vector3f& upper);
    void belowPlane(const MeshModel& mesh, const Eigen::Vector3f& normal, float offset);
    [[nodiscard]] std::span<const std::uint32_t> triangles() const { return m_triangles; }
    [[nodiscard]] std::uint64_t work() const { return m_choice != nullptr ? 0 : (m_triangles.size() + 15) / 16; }

  private:
    void unpack(const MeshModel& mesh);
    LeafChoice* m_choice = nullptr;
    std::vector<std::uint32_t> m_leaves;
    std::vector<std::uint32_t> m_triangles;
};

/// A feature key of a mesh's triangle: 0..2 corner, 3..5 edge, 6 face.
[[nodiscard]] std::uint64_t meshFeatureKey(const MeshModel& mesh, std::uint32_t triangle, int feature);

struct Ball {
    Eigen::Vector3f center;  ///< mesh frame
    float radius = 0;
    /// Unit directions from the centre into the rest of its body (a capsule's axis, a box's edges): a contact that is
    /// deeper further along one of them is not reported.
    std::span<const Eigen::Vector3f> body;
    std::uint64_t key = 0;  ///< its name in feature pairs
};

/// The locally closest features of the mesh to the centre. If the centre is inside a solid mesh, however deep: the
/// nearest admissible way out alone. Returns the work.
std::uint64_t pointContacts(const MeshModel& mesh, const Ball& ball, float maxDistance,
                            const LocalContactSettings& settings, Candidates& candidates, ContactCollector& out);

/// What boxContacts looks at, one after the other. Returns the work that it may want beyond leaves.
std::uint64_t boxRegions(const MeshModel& mesh, const BoxSolid& box, float maxDistance, std::vector<SearchRegion>& out);

/// Buffers of one thread.
struct ConvexScratch {
    Candidates candidates;
    ContactCollector collector;
};
/// Emptied; for the leaves of the choice alone, if there is one.
[[nodiscard]] ConvexScratch& convexScratch(LeafChoice* choice);

/// Error of coordinates in a mesh's frame up to this distance from its origin, m.
[[nodiscard]] float coordinateRounding(float extent);

}  // namespace grapeshot::detail
