// Where two meshes push each other apart, as well as a budget allows: regions from what the trees know of the surfaces,
// exact ones as they come up, and one solid inside the other.
#pragma once

#include <vector>

#include <grapeshot/adb/crossing.hpp>
#include <grapeshot/narrowphase/crossing_regions.hpp>
#include <grapeshot/narrowphase/mesh_model.hpp>
#include <grapeshot/narrowphase/surface_contact.hpp>

namespace grapeshot {

struct ContactEstimateSettings {
    /// Along a curve normals turn more than among contacts, so the cone is wider than theirs.
    RegionSettings regions{.spacing = 0.1F, .normalCone = 0.5F};
    CrossingSettings crossing;
    Interior interior = Interior::solid;
};

struct ContactEstimate {
    /// By decreasing expected length; see takeRegions for which to believe. A solid inside another is a proven region
    /// of length 0, at a vertex of it and where that comes out soonest.
    std::vector<CrossingRegion> regions;
    /// P(the meshes collide), by the calibration; 1 only if proven. 0 only if certain. (Triangles in one plane that
    /// look the same way prove it without a region: they push no way.)
    float probability = 0;
    bool certain = false;  ///< all regions are proven and none is missing
    StopReason stop = StopReason::invalidInput;
    std::uint64_t work = 0;  ///< work units; the search for containment is not counted
};

/// One estimate that can be stopped and resumed. Keeps references to both models. The rules of CrossingQuery hold.
class ContactEstimator {
  public:
    ContactEstimator(const MeshModel& a, const MeshModel& b) : m_a(&a), m_b(&b), m_query(a.tree, b.tree) {}

    /// `out` is overwritten and its memory kept. A spacing that is not above 0 or not finite, a cone that is NaN, or
    /// what CrossingQuery refuses: StopReason::invalidInput.
    void find(const Pose& bInA, const ContactEstimateSettings& settings, Budget budget, ContactEstimate& out);
    void resume(Budget budget, ContactEstimate& out);

  private:
    void fill(ContactEstimate& out);

    const MeshModel* m_a;
    const MeshModel* m_b;
    CrossingQuery m_query;
    Crossing m_crossing;
    Pose m_pose;
    ContactEstimateSettings m_settings;
    bool m_askedContainment = false;  ///< in this pose: the answer stays the same
    std::vector<SurfaceContact> m_contained;
};

}  // namespace grapeshot
