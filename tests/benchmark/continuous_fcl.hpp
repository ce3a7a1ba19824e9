// FCL's continuous collision of rigid meshes, by its conservative advancement and by its substeps.
#pragma once

#include <memory>
#include <optional>

#include <grapeshot/core/mesh_view.hpp>
#include <grapeshot/core/pose.hpp>

namespace grapeshot::bench {

enum class FclSolver { advancement, substeps };

class FclMoving {
  public:
    explicit FclMoving(MeshView mesh);
    /// Time of contact in 0..1 of both going from one pose to the other, straight and at a constant rate of turning;
    /// nothing if there is none.
    /// @param timeError its stop; of substeps their length
    [[nodiscard]] std::optional<double> impact(const Pose& from, const Pose& to, const FclMoving& other,
                                               const Pose& otherFrom, const Pose& otherTo, double timeError,
                                               FclSolver solver) const;

  private:
    struct Data;
    std::shared_ptr<Data> m_data;
};

}  // namespace grapeshot::bench
