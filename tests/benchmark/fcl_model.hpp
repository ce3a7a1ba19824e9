// FCL's hierarchy over one mesh: what it takes to build and refit, and what it answers.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>

#include <grapeshot/core/mesh_view.hpp>
#include <grapeshot/core/pose.hpp>

namespace grapeshot::bench {

/// Positions as FCL takes them, made beforehand where only FCL's own work is to be timed.
class FclPoints {
  public:
    explicit FclPoints(std::span<const Eigen::Vector3f> points);

  private:
    friend class FclModel;
    struct Data;
    std::shared_ptr<const Data> m_data;
};
class FclTriangles {
  public:
    explicit FclTriangles(std::span<const Triangle> triangles);

  private:
    friend class FclModel;
    struct Data;
    std::shared_ptr<const Data> m_data;
};

/// Of its continuous collision: by conservative advancement, and by substeps.
enum class FclSolver { advancement, substeps };

/// FCL as Debian ships it: double precision, oriented boxes with rectangle swept spheres. Copies share the hierarchy.
class FclModel {
  public:
    explicit FclModel(MeshView mesh);
    FclModel(const FclPoints& points, const FclTriangles& triangles);

    /// The same triangles elsewhere, bottom-up. Not by FCL's "update", whose boxes would hold the old positions too.
    /// @throws std::runtime_error if FCL refuses
    void refit(const FclPoints& points);

    /// First contact only.
    [[nodiscard]] bool collides(const FclModel& b, const Pose& bInA) const;

    /// Time of contact in 0..1 of both going from one pose to the other, straight and at a constant rate of turning;
    /// nothing if there is none.
    /// @param timeError its stop; of substeps their length
    [[nodiscard]] std::optional<double> impact(const Pose& from, const Pose& to, const FclModel& other,
                                               const Pose& otherFrom, const Pose& otherTo, double timeError,
                                               FclSolver solver) const;

    struct Bytes {
        std::size_t nodes, mesh;  ///< mesh: vertices and indices
    };
    /// By the public counts; its private list of primitives (4 bytes a triangle) is not in them.
    [[nodiscard]] Bytes bytes() const;

  private:
    struct Data;
    std::shared_ptr<Data> m_data;
};

}  // namespace grapeshot::bench
