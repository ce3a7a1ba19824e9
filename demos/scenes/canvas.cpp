#include "canvas.hpp"

#include <png.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>

#include <grapeshot/core/error.hpp>
#include <scenes/stroke_font.hpp>

namespace grapeshot::scenes {

using Eigen::Vector2d;

Canvas::Canvas(int width, int height, const Colour& background)
    : m_width(width),
      m_height(height),
      m_samples(static_cast<std::size_t>(width * samples) * static_cast<std::size_t>(height * samples), background) {
    assert(width > 0 && height > 0);
}

void Canvas::rectangle(const Vector2d& corner, const Vector2d& size, const Colour& colour, float alpha) {
    const auto clip = [](double value, int limit) {
        return std::clamp(static_cast<int>(std::lround(value * samples)), 0, limit * samples);
    };
    for (int row = clip(corner.y(), m_height); row < clip(corner.y() + size.y(), m_height); ++row) {
        for (int column = clip(corner.x(), m_width); column < clip(corner.x() + size.x(), m_width); ++column) {
            sample(column, row) += alpha * (colour - sample(column, row));
        }
    }
}

void Canvas::polyline(std::span<const Vector2d> points, double thickness, const Colour& colour, float alpha) {
    Coverage coverage(m_width * samples, m_height * samples);
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
        coverage.add(points[i] * samples, points[i + 1] * samples, thickness * samples);
    }
    coverage.blend(*this, colour, alpha);
}

void Canvas::text(const Vector2d& at, std::string_view line, double size, const Colour& colour, Align align) {
    strokes(at, line, size, colour, align, false);
}

void Canvas::verticalText(const Vector2d& at, std::string_view line, double size, const Colour& colour, Align align) {
    strokes(at, line, size, colour, align, true);
}

void Canvas::strokes(const Vector2d& at, std::string_view line, double size, const Colour& colour, Align align,
                     bool upwards) {
    Coverage coverage(m_width * samples, m_height * samples);
    const double width = textWidth(line) * size;
    double pen = align == Align::left ? 0 : align == Align::centre ? -width / 2 : -width;
    const auto place = [&](const Vector2d& p) -> Vector2d {
        const double along = pen + p.x() * size;
        const double above = p.y() * size;
        return samples * (at + (upwards ? Vector2d(-above, -along) : Vector2d(along, -above)));
    };
    for (const char c : line) {
        const Glyph shape = glyph(c);
        for (const auto& stroke : shape.strokes) {
            for (std::size_t i = 0; i + 1 < stroke.size(); ++i) {
                coverage.add(place(stroke[i]), place(stroke[i + 1]), std::max(1.1, 0.125 * size) * samples);
            }
        }
        pen += shape.advance * size;
    }
    coverage.blend(*this, colour, 1);
}

void Canvas::paste(const Canvas& other, int column, int row) {
    const int rows = std::min(other.m_height, m_height - row) * samples;
    const int columns = std::min(other.m_width, m_width - column) * samples;
    for (int y = 0; y < rows; ++y) {
        for (int x = 0; x < columns; ++x) {
            sample(column * samples + x, row * samples + y) = other.sample(x, y);
        }
    }
}

void Canvas::save(const std::filesystem::path& file) const {
    std::vector<std::uint8_t> bytes;
    bytes.reserve(static_cast<std::size_t>(m_width) * static_cast<std::size_t>(m_height) * 3);
    const auto columns = static_cast<std::size_t>(m_width) * samples;
    for (std::size_t y = 0; y < static_cast<std::size_t>(m_height); ++y) {
        for (std::size_t x = 0; x < static_cast<std::size_t>(m_width); ++x) {
            Colour mean = Colour::Zero();
            for (std::size_t k = 0; k < samples * samples; ++k) {
                mean += m_samples[(y * samples + k / samples) * columns + x * samples + k % samples];
            }
            mean /= samples * samples;
            for (int channel = 0; channel < 3; ++channel) {
                bytes.push_back(static_cast<std::uint8_t>(std::lround(255 * std::clamp(mean[channel], 0.0F, 1.0F))));
            }
        }
    }
    png_image image;
    std::memset(&image, 0, sizeof image);
    image.version = PNG_IMAGE_VERSION;
    image.width = static_cast<png_uint_32>(m_width);
    image.height = static_cast<png_uint_32>(m_height);
    image.format = PNG_FORMAT_RGB;
    if (png_image_write_to_file(&image, file.c_str(), 0, bytes.data(), 0, nullptr) == 0) {
        throw Error(Fault::badFile, image.message, file.string());
    }
}

Coverage::Coverage(int columns, int rows)
    : m_columns(columns), m_rows(rows), m_cover(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows)) {}

void Coverage::add(const Vector2d& from, const Vector2d& to, double thickness, float weight) {
    if (!from.allFinite() || !to.allFinite()) {
        return;
    }
    const double radius = 0.5 * thickness;
    const Vector2d reach = Vector2d::Constant(radius + 1);
    const Vector2d limit(m_columns - 1, m_rows - 1);
    const Vector2d lower = (from.cwiseMin(to) - reach).cwiseMax(0).cwiseMin(limit);
    const Vector2d upper = (from.cwiseMax(to) + reach).cwiseMax(0).cwiseMin(limit);
    const Vector2d along = to - from;
    const double squared = std::max(along.squaredNorm(), 1e-12);
    for (int row = static_cast<int>(lower.y()); row <= static_cast<int>(upper.y()); ++row) {
        for (int column = static_cast<int>(lower.x()); column <= static_cast<int>(upper.x()); ++column) {
            const Vector2d p(column + 0.5, row + 0.5);
            const double t = std::clamp((p - from).dot(along) / squared, 0.0, 1.0);
            const double cover = std::clamp(radius + 0.5 - (p - from - t * along).norm(), 0.0, 1.0);
            float& cell = m_cover[static_cast<std::size_t>(row) * static_cast<std::size_t>(m_columns) +
                                  static_cast<std::size_t>(column)];
            cell = std::max(cell, weight * static_cast<float>(cover));
        }
    }
}

void Coverage::blend(Canvas& canvas, const Colour& colour, float alpha) const {
    for (int row = 0; row < m_rows; ++row) {
        for (int column = 0; column < m_columns; ++column) {
            const float cover = m_cover[static_cast<std::size_t>(row) * static_cast<std::size_t>(m_columns) +
                                        static_cast<std::size_t>(column)];
            if (cover > 0) {
                Colour& sample = canvas.sample(column, row);
                sample += alpha * cover * (colour - sample);
            }
        }
    }
}

}  // namespace grapeshot::scenes
