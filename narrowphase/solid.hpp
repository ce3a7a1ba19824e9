// Planes and convex solids as a search within a budget sees them: what is near, what is asked where, and the contacts
// of some leaf blocks of a mesh.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include <grapeshot/narrowphase/convex_contacts.hpp>
#include <grapeshot/narrowphase/search_region.hpp>
#include <grapeshot/narrowphase/stand_in.hpp>

namespace grapeshot {

/// A solid at its place in a mesh's frame. Not for two threads, as far as it says so itself.
class Solid {
  public:
    virtual ~Solid() = default;

    /// No point of the box (mesh frame; half extents) is nearer to the solid's surface than this, m; negative inside.
    [[nodiscard]] virtual float distanceBound(const Eigen::Vector3f& center, const Eigen::Vector3f& half) const = 0;
    /// What `contacts` looks at: triangles that are in none of these parts of space cause no contact. A leaf is paid
    /// for once for each that it is in. Appended. Returns the work units that it may want beyond leaves.
    virtual std::uint64_t regions(const MeshModel& mesh, float maxDistance, std::vector<SearchRegion>& out) const = 0;
    /// Quarters of a work unit that a leaf costs in one region: four triangles by the kernels' measure are one.
    [[nodiscard]] virtual std::uint64_t leafQuarters() const { return 1; }
    /// Appends contacts as the functions of convex_contacts.hpp do; null: of all leaves. Returns the work, which with a
    /// choice is already paid for.
    virtual std::uint64_t contacts(const MeshModel& mesh, float maxDistance, const LocalContactSettings& settings,
                                   std::vector<SurfaceContact>& out, LeafChoice* choice) const = 0;
    /// Work units of a stand-in for contacts that `contacts` finds with all leaves alone; 0: there are none such.
    [[nodiscard]] virtual std::uint64_t standInWork() const { return 0; }
    /// Such a stand-in, as standInContacts. Returns the work, which is at most `work`.
    virtual std::uint64_t standIn(const MeshModel&, const RegionSettings&, float /*mostDepth*/, std::uint64_t /*work*/,
                                  std::vector<SurfaceContact>&) const {
        return 0;
    }
    /// Are they all there is in one step, or does it take several to gather them?
    [[nodiscard]] virtual bool isWhole() const { return true; }

  protected:
    Solid() = default;
    Solid(const Solid&) = default;
    Solid& operator=(const Solid&) = default;
};

class PlacedPlane final : public Solid {
  public:
    explicit PlacedPlane(const PlaneSolid& plane) : m_plane(plane) {}
    [[nodiscard]] float distanceBound(const Eigen::Vector3f& center, const Eigen::Vector3f& half) const override;
    std::uint64_t regions(const MeshModel& mesh, float maxDistance, std::vector<SearchRegion>& out) const override;
    std::uint64_t contacts(const MeshModel& mesh, float maxDistance, const LocalContactSettings& settings,
                           std::vector<SurfaceContact>& out, LeafChoice* choice) const override;

  private:
    PlaneSolid m_plane;
};

/// A sphere is one whose ends are the same.
class PlacedCapsule final : public Solid {
  public:
    explicit PlacedCapsule(const CapsuleSolid& capsule) : m_capsule(capsule) {}
    [[nodiscard]] float distanceBound(const Eigen::Vector3f& center, const Eigen::Vector3f& half) const override;
    std::uint64_t regions(const MeshModel& mesh, float maxDistance, std::vector<SearchRegion>& out) const override;
    std::uint64_t contacts(const MeshModel& mesh, float maxDistance, const LocalContactSettings& settings,
                           std::vector<SurfaceContact>& out, LeafChoice* choice) const override;

  private:
    [[nodiscard]] bool isSphere() const { return m_capsule.from == m_capsule.to; }
    CapsuleSolid m_capsule;
};

class PlacedBox final : public Solid {
  public:
    explicit PlacedBox(const BoxSolid& box) : m_box(box) {}
    [[nodiscard]] float distanceBound(const Eigen::Vector3f& center, const Eigen::Vector3f& half) const override;
    std::uint64_t regions(const MeshModel& mesh, float maxDistance, std::vector<SearchRegion>& out) const override;
    std::uint64_t contacts(const MeshModel& mesh, float maxDistance, const LocalContactSettings& settings,
                           std::vector<SurfaceContact>& out, LeafChoice* choice) const override;
    [[nodiscard]] std::uint64_t standInWork() const override { return grapeshot::standInWork; }
    std::uint64_t standIn(const MeshModel& mesh, const RegionSettings& regions, float mostDepth, std::uint64_t work,
                          std::vector<SurfaceContact>& out) const override;

  private:
    BoxSolid m_box;
};

/// Bound as Solid::distanceBound for a box: also of solids within it.
[[nodiscard]] float boxDistanceBound(const BoxSolid& box, const Eigen::Vector3f& center, const Eigen::Vector3f& half);

}  // namespace grapeshot
