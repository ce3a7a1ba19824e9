// A needle that flies at a waving cloth with holes, in one step: hits, and misses past the edge and through a hole.
#pragma once

#include <Eigen/Core>
#include <vector>

#include <scenes/shapes.hpp>
#include <support/poses.hpp>

namespace grapeshot::bench {

struct TunnelEvent {
    std::vector<Eigen::Vector3f> clothBefore, clothNow, needleBefore, needleNow;
};

class TunnelScene {
  public:
    /// @param cells of the cloth along each side
    explicit TunnelScene(int cells);
    /// @param speed of the needle, diagonals of the cloth per step. @param still the cloth stays as it is at rest
    [[nodiscard]] TunnelEvent event(float speed, bool still, test::Random& random) const;

    scenes::Mesh cloth, needle;  ///< box diagonal of the cloth 1 m; the needle 0.1 m long, 3 mm in radius

  private:
    [[nodiscard]] std::vector<Eigen::Vector3f> waved(float phase) const;
};

}  // namespace grapeshot::bench
