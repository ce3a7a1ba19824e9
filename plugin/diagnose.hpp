// What in a world will not collide, or not well, and what to do about it.
#pragma once

#include <iosfwd>
#include <string>
#include <string_view>
#include <vector>

#include <grapeshot/plugin/precision.hpp>
#include <grapeshot/plugin/status.hpp>

class btCollisionShape;
class btCollisionWorld;

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {

/// `value` of the finding in brackets.
enum class FindingCode {
    // Pairs
    noAlgorithm,   ///< bodies that their filters let meet and that pass through each other [pairs of these kinds]
    overtaken,     ///< somebody, say GImpact, has registered over our algorithms [places lost]
    oldAlgorithm,  ///< pairs made before the registration keep Bullet's algorithm until they part [pairs]
    zeroMassPair,  ///< nobody moves and one is concave, but their filters let them meet: work for nothing [pairs]
    // Bodies
    notFinite,      ///< a pose or velocity that is no number
    notRigid,       ///< a pose whose rotation is no rotation
    farFromOrigin,  ///< poses are rounded by a hundredth of the contact breaking threshold or more [rounding, m]
    noInertia,      ///< a moving mesh that cannot turn, as Bullet makes moving BVH meshes: see massProperties
    // Meshes
    unusableMesh,         ///< refused: empty, NaN, indices out of range, ...
    openMesh,             ///< no inside; of moving bodies a warning [boundary edges]
    insideOut,            ///< closed, but the normals point inwards [volume, m^3]
    degenerateTriangles,  ///< without area [how many]
    imprecise,            ///< too far from its own origin for its finest edge [rounding / shortest edge]
    badScale,             ///< a local scaling of zero or no number
    nonUniformScale,      ///< Bullet scales the shape but not its margin [largest / smallest factor]
    tiny,                 ///< a moving mesh smaller than the contact breaking threshold [half diagonal, m]
    huge,                 ///< rounded by a hundredth of the contact breaking threshold or more [largest coordinate, m]
    badMargin,            ///< negative or no number [margin, m]
    largeMargin,          ///< thinner than its two margins, or open and not ten times larger [margin / thickness]
    // Budget: the last step's statistics
    refused,              ///< pairs without an answer [pairs]
    degraded,             ///< pairs cut short [pairs]
    mandatoryOverBudget,  ///< the mandatory slices alone come to more than the budget [their sum / budget]
    droppedRegions,       ///< contact regions beyond Settings::maxManifolds [regions]
    fallbacks,            ///< pairs that Bullet's GImpact algorithm got for want of any other [pairs]
};
[[nodiscard]] std::string_view name(FindingCode code) noexcept;

enum class Severity {
    note,     ///< as meant, perhaps
    warning,  ///< collides, but worse than it could
    error,    ///< contacts are missing
};
[[nodiscard]] std::string_view name(Severity severity) noexcept;

struct Finding {
    FindingCode code = FindingCode::noAlgorithm;
    Severity severity = Severity::note;
    /// Where: indices into btCollisionWorld::getCollisionObjectArray(), -1 if it is about no body or no second one. Of
    /// several alike the first.
    int first = -1, second = -1;
    const btCollisionShape* shape = nullptr;  ///< the leaf shape, within a compound perhaps; null: not about one
    double value = 0;                         ///< see FindingCode
    std::string message;                      ///< a sentence or two, with what to do
};

struct Diagnosis {
    /// ok; else there are no findings: nullPointer, badArgument (the world's dispatcher is no btCollisionDispatcher),
    /// outOfMemory.
    Status status = Status::ok;
    std::vector<Finding> findings;  ///< errors first, then in the order of FindingCode and bodies
};

/// Looks at all bodies, their shapes (each once, every triangle) and the kinds of pairs that the broadphase filters
/// allow, of each kind at one. Changes nothing, builds no trees. For start-up or a debug key: O(n log n) in triangles,
/// O(k^2) in kinds of bodies (shape types and filters). Between steps.
[[nodiscard]] Diagnosis diagnose(const btCollisionWorld* world) noexcept;

/// "warning: openMesh (body 3): ...", one line; of a diagnosis one line each, or "nothing to report". Allocates.
[[nodiscard]] std::string toText(const Finding& finding);
[[nodiscard]] std::string toText(const Diagnosis& diagnosis);
std::ostream& operator<<(std::ostream& out, const Finding& finding);
std::ostream& operator<<(std::ostream& out, const Diagnosis& diagnosis);

}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
