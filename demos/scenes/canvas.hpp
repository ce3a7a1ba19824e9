// A picture to draw on: lines, text, rectangles; saved as PNG.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

namespace grapeshot::scenes {

/// Red, green, blue, each 0 to 1, as a screen shows them.
using Colour = Eigen::Vector3f;

enum class Align { left, centre, right };

/// Coordinates are pixels of the saved picture, x to the right, y down, the corner of the first pixel at (0, 0).
/// Every pixel is the mean of 2 x 2 samples.
class Canvas {
  public:
    Canvas(int width, int height, const Colour& background);

    [[nodiscard]] int width() const { return m_width; }
    [[nodiscard]] int height() const { return m_height; }

    void rectangle(const Eigen::Vector2d& corner, const Eigen::Vector2d& size, const Colour& colour, float alpha = 1);
    /// One stroke: where it crosses itself it is no darker.
    void polyline(std::span<const Eigen::Vector2d> points, double thickness, const Colour& colour, float alpha = 1);
    /// `size` is the height of a capital letter; `at` is on the baseline.
    void text(const Eigen::Vector2d& at, std::string_view line, double size, const Colour& colour,
              Align align = Align::left);
    /// The same, reading upwards.
    void verticalText(const Eigen::Vector2d& at, std::string_view line, double size, const Colour& colour,
                      Align align = Align::left);

    /// Another picture's samples, its first pixel at the given one.
    void paste(const Canvas& other, int column, int row);

    /// Throws Error (badFile) if the file cannot be written.
    void save(const std::filesystem::path& file) const;

    /// For those who draw by themselves: samples per pixel and side, and one sample.
    static constexpr int samples = 2;
    [[nodiscard]] Colour& sample(int column, int row) { return m_samples[index(column, row)]; }
    [[nodiscard]] const Colour& sample(int column, int row) const { return m_samples[index(column, row)]; }

  private:
    [[nodiscard]] std::size_t index(int column, int row) const {
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(m_width * samples) +
               static_cast<std::size_t>(column);
    }
    void strokes(const Eigen::Vector2d& at, std::string_view line, double size, const Colour& colour, Align align,
                 bool upwards);

    int m_width;
    int m_height;
    std::vector<Colour> m_samples;
};

/// How much of each sample a set of strokes covers; blended once, so that overlaps do not add up.
class Coverage {
  public:
    Coverage(int columns, int rows);
    /// Both in samples; `weight` (0 to 1) scales what this piece covers.
    void add(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double thickness, float weight = 1);
    void blend(Canvas& canvas, const Colour& colour, float alpha) const;

  private:
    int m_columns;
    int m_rows;
    std::vector<float> m_cover;
};

}  // namespace grapeshot::scenes
