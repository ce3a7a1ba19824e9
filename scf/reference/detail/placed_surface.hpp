// A surface at one step: where its features are and how large.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include <grapeshot/scf/reference/detail/shallow_tree.hpp>
#include <grapeshot/scf/reference/surface.hpp>

namespace grapeshot::scf::reference::detail {

/// Borrows surface and vertices for the length of a step.
class PlacedSurface {
  public:
    /// O(vertices), as every refit. @throws Error topologyChanged, notFinite; both name `place`
    PlacedSurface(const Surface& surface, std::span<const Eigen::Vector3f> vertices, const char* place);

    [[nodiscard]] const Surface& surface() const { return *m_surface; }
    [[nodiscard]] std::span<const Eigen::Vector3f> vertices() const { return m_vertices; }
    [[nodiscard]] const Level& level(std::size_t l) const { return m_surface->levels[l]; }
    [[nodiscard]] const Eigen::Vector3f& at(std::size_t l, std::uint32_t feature) const {
        return m_vertices[level(l).centre[feature]];
    }
    /// Level 0: the longest edge around it, so that the ball holds its triangles; coarser: holds all features below.
    [[nodiscard]] float radius(std::size_t l, std::uint32_t feature) const { return m_radii[l][feature]; }
    [[nodiscard]] std::span<const Bounds> boxes() const { return m_boxes; }
    [[nodiscard]] float size() const { return (m_boxes[0].upper - m_boxes[0].lower).norm(); }
    [[nodiscard]] std::array<Eigen::Vector3f, 3> corners(std::uint32_t triangle) const;

  private:
    const Surface* m_surface;
    std::span<const Eigen::Vector3f> m_vertices;
    std::vector<std::vector<float>> m_radii;
    std::vector<Bounds> m_boxes;
};

}  // namespace grapeshot::scf::reference::detail
