// FCL as Debian ships it: double precision, oriented boxes with rectangle swept spheres, first contact only.
#pragma once

#include <memory>

#include <grapeshot/core/mesh_view.hpp>
#include <grapeshot/core/pose.hpp>

namespace grapeshot::bench {

class FclModel {
  public:
    explicit FclModel(MeshView mesh);
    ~FclModel();
    FclModel(FclModel&&) noexcept;
    FclModel& operator=(FclModel&&) noexcept;

    /// Do the surfaces of this model and of `other`, posed in this model's frame, intersect?
    [[nodiscard]] bool decide(const FclModel& other, const Pose& otherInThis) const;

  private:
    struct State;
    std::unique_ptr<State> m_state;
};

}  // namespace grapeshot::bench
