// A mesh against simple solids: plane, sphere, capsule, box; analytic on the leaves that the tree does not exclude.
//
// The mesh is A. Every solid is given in the mesh's frame. A mesh vertex deep inside the solid is a contact however
// deep. Contacts are local extrema on the mesh side, as in local_contacts.hpp. Appended to `out`; normal on the solid
// pointing to the mesh. Each returns its work in units (16 triangles each). Preconditions: finite arguments, radii and
// extents >= 0. Searches that a budget may end are solid_update.hpp's.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include <grapeshot/core/pose.hpp>
#include <grapeshot/core/purse.hpp>
#include <grapeshot/narrowphase/local_contacts.hpp>
#include <grapeshot/narrowphase/mesh_model.hpp>
#include <grapeshot/narrowphase/surface_contact.hpp>

namespace grapeshot {

/// Half-space normal . x <= offset.
struct PlaneSolid {
    Eigen::Vector3f normal;  ///< unit, out of the solid
    float offset = 0;        ///< m
};
struct SphereSolid {
    Eigen::Vector3f center;
    float radius = 0;  ///< m
};
struct CapsuleSolid {
    Eigen::Vector3f from, to;  ///< ends of the axis
    float radius = 0;
};
struct BoxSolid {
    Pose pose;             ///< of the box in the mesh's frame
    Eigen::Vector3f half;  ///< half extents, m
};

/// Leaf blocks of the mesh to which a search is confined because a budget does not last for all.
struct LeafChoice {
    std::span<const std::uint32_t> leaves;  ///< ascending; their tests are paid for
    bool all = true;                        ///< no other leaf touches the solid
    Purse& purse;                           ///< for all that is not leaf by leaf
    std::uint64_t turn = 0;                 ///< what does not fit into every step begins elsewhere in each of these
    bool complete = true;                   ///< set to false where the purse was empty too early
    /// Pays, or says that the search is not complete.
    bool pay(std::uint64_t work);
};

/// With a choice the work that is returned is already paid for.
std::uint64_t planeContacts(const MeshModel& mesh, const PlaneSolid& plane, float maxDistance,
                            const LocalContactSettings& settings, std::vector<SurfaceContact>& out,
                            LeafChoice* choice = nullptr);
std::uint64_t sphereContacts(const MeshModel& mesh, const SphereSolid& sphere, float maxDistance,
                             const LocalContactSettings& settings, std::vector<SurfaceContact>& out,
                             LeafChoice* choice = nullptr);
std::uint64_t capsuleContacts(const MeshModel& mesh, const CapsuleSolid& capsule, float maxDistance,
                              const LocalContactSettings& settings, std::vector<SurfaceContact>& out,
                              LeafChoice* choice = nullptr);
std::uint64_t boxContacts(const MeshModel& mesh, const BoxSolid& box, float maxDistance,
                          const LocalContactSettings& settings, std::vector<SurfaceContact>& out,
                          LeafChoice* choice = nullptr);

/// Is the direction from the witness point `onMesh` of `triangle` (feature code as in DistanceBatch) towards the other
/// body, `towardsOther` (unit), locally extremal on the mesh: no surface direction leans towards it by more than the
/// tolerance, and it points out of the mesh? For callers that find witness points themselves (GJK per triangle).
[[nodiscard]] bool isLocalExtremum(const MeshModel& mesh, std::uint32_t triangle, int feature,
                                   const Eigen::Vector3f& towardsOther, const LocalContactSettings& settings);

}  // namespace grapeshot
