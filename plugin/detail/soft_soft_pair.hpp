// Two soft bodies, or one with itself, from step to step.
#pragma once

#include <BulletSoftBody/btSoftBody.h>

#include <memory>
#include <optional>
#include <vector>

#include <grapeshot/plugin/detail/node_face.hpp>
#include <grapeshot/plugin/detail/soft_rigid_pair.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

struct SoftSoftTask {
    std::uint64_t look = 0;  ///< see SoftEntry
    std::uint64_t key = 0;
    float distance = 0;                      ///< m, at which they touch
    float exclusion = 0;                     ///< m, of one with itself: see TrackSettings
    float spacing = 0;                       ///< m; 0: half an edge
    SoftWorld world = SoftWorld::positions;  ///< of both
    btScalar timeStep = 0;                   ///< s
    Budget budget;
};

class SoftSoftPair {
  public:
    explicit SoftSoftPair(Context& context) : m_context(context) {}

    /// The same body twice: with itself. During a dispatch.
    SoftPairResult process(btSoftBody& a, btSoftBody& b, const SoftSoftTask& task);
    void forget();
    /// Those of the last step that the body has a part in.
    void appendContacts(const btSoftBody& body, std::vector<SoftContact>& contacts) const;

  private:
    struct Side {
        const btSoftBody* body = nullptr;
        std::shared_ptr<SoftEntry> entry;
        std::shared_ptr<const SoftSurface> surface;
        std::vector<Eigen::Vector3f> last, before, after;
    };
    bool findSurfaces(btSoftBody& a, btSoftBody& b, const SoftSoftTask& task, std::string& refusal);
    bool readPositions(btSoftBody& a, btSoftBody& b, const SoftSoftTask& task);
    SurfaceInStep inStep(const Side& side) const;
    /// Everything, by what neighbourhoods move against each other.
    Faced findFaced(float distance, std::uint64_t mostWork, NearResult& result);
    /// The same if the budget is likely to be enough: that takes a small part of what sampling all pairs of triangles
    /// within the distance does. None: it was not enough, or is not tried in this step.
    std::optional<Faced> tryFaced(const SoftSoftTask& task, NearResult& result);
    int write(btSoftBody& a, btSoftBody& b, const SoftSoftTask& task);

    Context& m_context;
    Side m_a, m_b;  // of one with itself only the first
    bool m_itself = false;
    std::unique_ptr<NearPairs> m_near;
    IndexLists m_nearVertices;
    float m_nearDistance = -1;
    SurfaceContacts m_sides;
    btVector3 m_origin{0, 0, 0};                        // of the frame, world
    Eigen::Vector3f m_drift = Eigen::Vector3f::Zero();  // mean motion, taken out of `after` and `last`
    float m_usualWay = 0;
    std::vector<TrianglePair> m_pairs;
    std::unique_ptr<FacingQuery> m_facing;
    FacingResult m_faced;
    std::uint64_t m_facedNeed = 0;  // units, by the last steps
    std::vector<SoftSurfaceContact> m_contacts;
    std::vector<NodeFace> m_parts;
};

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
