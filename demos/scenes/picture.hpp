// A scene seen through a camera: shaded meshes, their shadows on the ground, paths through the air.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include <scenes/canvas.hpp>
#include <scenes/shapes.hpp>
#include <scenes/true_penetration.hpp>

namespace grapeshot::scenes {

struct Camera {
    Eigen::Vector3d eye{-6, 4, -7};  ///< world frame, m; y is up
    Eigen::Vector3d target{0, 1, 0};
    double fieldOfView = 40;  ///< of the picture's height, degrees
};

/// Draw in this order: constructor (sky), ground, shadows, meshes, paths, text on `canvas()`.
class Picture {
  public:
    Picture(int width, int height, const Camera& camera);

    /// The plane y = 0 in squares of 1 m.
    void ground();
    /// What the mesh keeps the sun from, on the plane y = 0. Blended by `blendShadows`.
    void shadow(const Mesh& mesh, const PoseD& pose);
    void blendShadows();
    void mesh(const Mesh& mesh, const PoseD& pose, const Colour& colour);
    /// Lines through the world; where a mesh is in front of them they are fainter.
    void path(std::span<const Eigen::Vector3d> points, double thickness, const Colour& colour, float alpha);

    [[nodiscard]] Canvas& canvas() { return m_canvas; }

  private:
    /// x, y in samples, z the distance along the view, m.
    [[nodiscard]] Eigen::Vector3d inView(const Eigen::Vector3d& world) const;
    [[nodiscard]] Eigen::Vector3d onScreen(const Eigen::Vector3d& view) const;
    template <class Paint>
    void triangle(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c, const Paint& paint);
    [[nodiscard]] std::size_t cell(int column, int row) const;

    Canvas m_canvas;
    int m_columns;
    int m_rows;
    Eigen::Vector3d m_eye;
    Eigen::Matrix3d m_axes;         ///< rows: right, down, forward
    double m_focal;                 ///< samples
    std::vector<float> m_nearness;  ///< 1 / distance along the view; 0: nothing drawn
    std::vector<std::uint8_t> m_shaded;
};

}  // namespace grapeshot::scenes
