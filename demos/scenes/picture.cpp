#include "picture.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace grapeshot::scenes {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

constexpr double nearPlane = 0.05;  // m
const Vector3d sun = Vector3d(-0.5, 0.8, -0.62).normalized();
const Colour horizon{0.93F, 0.95F, 0.97F};
const Colour zenith{0.62F, 0.75F, 0.90F};

/// A warm sun, a blue sky above and the light ground below.
Colour lit(const Colour& colour, const Vector3d& normal) {
    const auto direct = static_cast<float>(std::max(0.0, normal.dot(sun)));
    const auto up = static_cast<float>(0.5 + 0.5 * normal.y());
    const Colour sky = up * Colour(0.50F, 0.53F, 0.58F) + (1 - up) * Colour(0.33F, 0.31F, 0.29F);
    return colour.cwiseProduct(sky + direct * Colour(0.56F, 0.54F, 0.48F)).cwiseMin(1.0F);
}

}  // namespace

Picture::Picture(int width, int height, const Camera& camera)
    : m_canvas(width, height, horizon),
      m_columns(width * Canvas::samples),
      m_rows(height * Canvas::samples),
      m_eye(camera.eye),
      m_focal(0.5 * m_rows / std::tan(camera.fieldOfView * std::numbers::pi / 360)),
      m_nearness(static_cast<std::size_t>(m_columns) * static_cast<std::size_t>(m_rows)),
      m_shaded(m_nearness.size()) {
    const Vector3d forward = (camera.target - camera.eye).normalized();
    const Vector3d right = forward.cross(Vector3d::UnitY()).normalized();
    m_axes.row(0) = right;
    m_axes.row(1) = forward.cross(right);
    m_axes.row(2) = forward;
    for (int row = 0; row < m_rows; ++row) {
        for (int column = 0; column < m_columns; ++column) {
            const Vector3d ray((column + 0.5 - 0.5 * m_columns) / m_focal, (row + 0.5 - 0.5 * m_rows) / m_focal, 1);
            const double rise = (m_axes.transpose() * ray).normalized().y();
            m_canvas.sample(column, row) += static_cast<float>(std::clamp(2.5 * rise, 0.0, 1.0)) * (zenith - horizon);
        }
    }
}

std::size_t Picture::cell(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(m_columns) + static_cast<std::size_t>(column);
}

Vector3d Picture::inView(const Vector3d& world) const {
    return m_axes * (world - m_eye);
}

Vector3d Picture::onScreen(const Vector3d& view) const {
    return {0.5 * m_columns + m_focal * view.x() / view.z(), 0.5 * m_rows + m_focal * view.y() / view.z(), view.z()};
}

void Picture::ground() {
    const Colour light{0.86F, 0.85F, 0.81F};
    const Colour dark{0.81F, 0.80F, 0.76F};
    for (int row = 0; row < m_rows; ++row) {
        for (int column = 0; column < m_columns; ++column) {
            const Vector3d ray((column + 0.5 - 0.5 * m_columns) / m_focal, (row + 0.5 - 0.5 * m_rows) / m_focal, 1);
            const Vector3d direction = m_axes.transpose() * ray;
            if (direction.y() >= 0 || m_eye.y() <= 0) {
                continue;
            }
            const double distance = -m_eye.y() / direction.y();
            const Vector3d at = m_eye + distance * direction;
            const bool even = static_cast<long>(std::floor(at.x()) + std::floor(at.z())) % 2 == 0;
            // Far squares are smaller than a pixel: they fade, or they would flicker into stripes.
            const auto haze = static_cast<float>(1 - std::exp(-distance / 28));
            const Colour tile = even ? light : dark;
            m_canvas.sample(column, row) = tile + haze * (horizon - tile);
            m_nearness[cell(column, row)] = static_cast<float>(1 / distance);
        }
    }
}

template <class Paint>
void Picture::triangle(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Paint& paint) {
    const double area = (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
    if (area == 0) {
        return;
    }
    const Vector3d lower = a.cwiseMin(b).cwiseMin(c);
    const Vector3d upper = a.cwiseMax(b).cwiseMax(c);
    const int firstRow = static_cast<int>(std::clamp(std::floor(lower.y()), 0.0, m_rows - 1.0));
    const int lastRow = static_cast<int>(std::clamp(std::ceil(upper.y()), 0.0, m_rows - 1.0));
    const int firstColumn = static_cast<int>(std::clamp(std::floor(lower.x()), 0.0, m_columns - 1.0));
    const int lastColumn = static_cast<int>(std::clamp(std::ceil(upper.x()), 0.0, m_columns - 1.0));
    for (int row = firstRow; row <= lastRow; ++row) {
        for (int column = firstColumn; column <= lastColumn; ++column) {
            const Vector2d p(column + 0.5, row + 0.5);
            const double u = ((b.x() - p.x()) * (c.y() - p.y()) - (b.y() - p.y()) * (c.x() - p.x())) / area;
            const double v = ((c.x() - p.x()) * (a.y() - p.y()) - (c.y() - p.y()) * (a.x() - p.x())) / area;
            if (u >= 0 && v >= 0 && u + v <= 1) {
                paint(column, row, static_cast<float>(u / a.z() + v / b.z() + (1 - u - v) / c.z()));
            }
        }
    }
}

void Picture::shadow(const Mesh& mesh, const PoseD& pose) {
    for (const Triangle& t : mesh.triangles) {
        Vector3d p[3];
        bool visible = true;
        for (std::size_t k = 0; k < 3; ++k) {
            const Vector3d world = pose.rotation * mesh.vertices[t[k]].cast<double>() + pose.translation;
            const Vector3d view = inView(world - sun * (world.y() / sun.y()));
            visible = visible && view.z() > nearPlane && world.y() > -0.1;
            p[k] = onScreen(view);
        }
        if (visible) {
            triangle(p[0], p[1], p[2], [&](int column, int row, float) { m_shaded[cell(column, row)] = 1; });
        }
    }
}

void Picture::blendShadows() {
    for (int row = 0; row < m_rows; ++row) {
        for (int column = 0; column < m_columns; ++column) {
            if (m_shaded[cell(column, row)] != 0) {
                m_canvas.sample(column, row) = m_canvas.sample(column, row).cwiseProduct(Colour(0.62F, 0.63F, 0.67F));
            }
        }
    }
    std::ranges::fill(m_shaded, std::uint8_t{0});
}

void Picture::mesh(const Mesh& mesh, const PoseD& pose, const Colour& colour) {
    for (const Triangle& t : mesh.triangles) {
        Vector3d world[3];
        Vector3d p[3];
        bool visible = true;
        for (std::size_t k = 0; k < 3; ++k) {
            world[k] = pose.rotation * mesh.vertices[t[k]].cast<double>() + pose.translation;
            const Vector3d view = inView(world[k]);
            visible = visible && view.z() > nearPlane;
            p[k] = onScreen(view);
        }
        if (!visible) {
            continue;
        }
        Vector3d normal = (world[1] - world[0]).cross(world[2] - world[0]).normalized();
        if (normal.dot(m_eye - world[0]) < 0) {
            normal = -normal;
        }
        const Colour shade = lit(colour, normal);
        triangle(p[0], p[1], p[2], [&](int column, int row, float nearness) {
            float& before = m_nearness[cell(column, row)];
            if (nearness > before) {
                before = nearness;
                m_canvas.sample(column, row) = shade;
            }
        });
    }
}

void Picture::path(std::span<const Vector3d> points, double thickness, const Colour& colour, float alpha) {
    Coverage coverage(m_columns, m_rows);
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
        const Vector3d from = inView(points[i]);
        const Vector3d to = inView(points[i + 1]);
        if (!(from.z() > nearPlane && to.z() > nearPlane)) {
            continue;
        }
        // In short pieces, each of them in front of what is drawn there or behind it.
        const double length = (onScreen(to) - onScreen(from)).head<2>().norm();
        const int pieces = std::clamp(static_cast<int>(length / 6), 1, 400);
        for (int piece = 0; piece < pieces; ++piece) {
            const Vector3d a = onScreen(from + (to - from) * piece / pieces);
            const Vector3d b = onScreen(from + (to - from) * (piece + 1) / pieces);
            const Vector2d middle = 0.5 * (a + b).head<2>();
            const bool inside = middle.x() >= 0 && middle.y() >= 0 && middle.x() < m_columns && middle.y() < m_rows;
            const bool hidden = inside && m_nearness[cell(static_cast<int>(middle.x()), static_cast<int>(middle.y()))] >
                                              1.02 / (0.5 * (a.z() + b.z()));
            coverage.add(a.head<2>(), b.head<2>(), thickness * Canvas::samples, hidden ? 0.25F : 1.0F);
        }
    }
    coverage.blend(m_canvas, colour, alpha);
}

}  // namespace grapeshot::scenes
