#include "plot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include <scenes/stroke_font.hpp>

namespace grapeshot::scenes {

using Eigen::Vector2d;

namespace {

const Colour ink{0.13F, 0.13F, 0.15F};
const Colour faint{0.88F, 0.88F, 0.9F};
constexpr double textSize = 11;

struct Range {
    double low = 0;
    double high = 1;
};

std::string label(double value) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.4g", std::abs(value) < 1e-12 ? 0.0 : value);
    return text.data();
}

/// Steps of 1, 2 or 5 times a power of ten, about `wanted` of them.
std::vector<double> ticks(const Range& range, int wanted) {
    const double rough = (range.high - range.low) / wanted;
    const double power = std::pow(10, std::floor(std::log10(rough)));
    const double share = rough / power;
    const double step = power * (share < 1.5 ? 1 : share < 3.5 ? 2 : share < 7.5 ? 5 : 10);
    std::vector<double> result;
    for (double k = std::ceil(range.low / step - 1e-9); k * step <= range.high + 1e-9 * step; ++k) {
        result.push_back(k * step);
    }
    return result;
}

class Chart {
  public:
    Chart(const Plot& plot, int width, int height) : m_plot(plot), m_canvas(width, height, {1, 1, 1}) {}

    Canvas draw() {
        findRanges();
        m_left = 86;
        m_right = m_canvas.width() - 24.0;
        m_top = 58 + 22.0 * (m_plot.lines.size() > 1 ? 1 : 0);
        m_bottom = m_canvas.height() - 62.0;
        drawFrame();
        for (const Line& line : m_plot.lines) {
            drawLine(line);
        }
        drawLegend();
        return std::move(m_canvas);
    }

  private:
    [[nodiscard]] bool usable(double x, double y) const {
        return std::isfinite(x) && std::isfinite(y) && (!m_plot.logY || y > 0);
    }
    [[nodiscard]] double scaled(double y) const { return m_plot.logY ? std::log10(y) : y; }

    void findRanges() {
        bool any = false;
        for (const Line& line : m_plot.lines) {
            for (std::size_t i = 0; i < std::min(line.x.size(), line.y.size()); ++i) {
                if (!usable(line.x[i], line.y[i])) {
                    continue;
                }
                const double y = scaled(line.y[i]);
                m_x = any ? Range{std::min(m_x.low, line.x[i]), std::max(m_x.high, line.x[i])}
                          : Range{line.x[i], line.x[i]};
                m_y = any ? Range{std::min(m_y.low, y), std::max(m_y.high, y)} : Range{y, y};
                any = true;
            }
        }
        if (m_plot.logY) {
            m_y = {std::floor(m_y.low + 1e-9), std::ceil(m_y.high - 1e-9)};
        } else {
            m_y.low = std::min(m_y.low, 0.0);
            m_y.high += 0.05 * (m_y.high - m_y.low);
        }
        if (m_x.high <= m_x.low) {
            m_x.high = m_x.low + 1;
        }
        if (m_y.high <= m_y.low) {
            m_y.high = m_y.low + 1;
        }
    }

    [[nodiscard]] Vector2d place(double x, double scaledY) const {
        return {m_left + (x - m_x.low) / (m_x.high - m_x.low) * (m_right - m_left),
                m_bottom - (scaledY - m_y.low) / (m_y.high - m_y.low) * (m_bottom - m_top)};
    }

    void segment(const Vector2d& from, const Vector2d& to, const Colour& colour, double thickness = 1) {
        m_canvas.polyline(std::array{from, to}, thickness, colour);
    }

    void drawFrame() {
        for (const double x : ticks(m_x, 9)) {
            const double column = place(x, m_y.low).x();
            segment({column, m_top}, {column, m_bottom}, faint);
            m_canvas.text({column, m_bottom + 22}, label(x), textSize, ink, Align::centre);
        }
        const std::vector<double> rows = m_plot.logY ? ticks(m_y, static_cast<int>(m_y.high - m_y.low)) : ticks(m_y, 7);
        for (const double y : rows) {
            const double row = place(m_x.low, y).y();
            segment({m_left, row}, {m_right, row}, faint);
            m_canvas.text({m_left - 9, row + textSize / 2}, label(m_plot.logY ? std::pow(10, y) : y), textSize, ink,
                          Align::right);
        }
        segment({m_left, m_top}, {m_left, m_bottom}, ink, 1.3);
        segment({m_left, m_bottom}, {m_right, m_bottom}, ink, 1.3);
        m_canvas.text({m_left, 34}, m_plot.title, 15, ink);
        m_canvas.text({0.5 * (m_left + m_right), m_canvas.height() - 16.0}, m_plot.xLabel, 12, ink, Align::centre);
        m_canvas.verticalText({22, 0.5 * (m_top + m_bottom)}, m_plot.yLabel, 12, ink, Align::centre);
    }

    void drawLine(const Line& line) {
        std::vector<Vector2d> points;
        for (std::size_t i = 0; i < std::min(line.x.size(), line.y.size()); ++i) {
            if (usable(line.x[i], line.y[i])) {
                points.push_back(place(line.x[i], scaled(line.y[i])));
            }
        }
        m_canvas.polyline(points, line.thickness, line.colour);
    }

    void drawLegend() {
        if (m_plot.lines.size() < 2) {
            return;
        }
        double x = m_left;
        const double y = 60;
        for (const Line& line : m_plot.lines) {
            if (line.label.empty()) {
                continue;
            }
            segment({x, y - 4}, {x + 26, y - 4}, line.colour, 3);
            m_canvas.text({x + 33, y}, line.label, textSize, ink);
            x += 33 + textWidth(line.label) * textSize + 26;
        }
    }

    const Plot& m_plot;
    Canvas m_canvas;
    Range m_x;
    Range m_y;
    double m_left = 0;
    double m_right = 0;
    double m_top = 0;
    double m_bottom = 0;
};

}  // namespace

Colour seriesColour(std::size_t index) {
    static const std::array<Colour, 7> colours{Colour{0.00F, 0.45F, 0.70F}, Colour{0.84F, 0.37F, 0.00F},
                                               Colour{0.00F, 0.62F, 0.45F}, Colour{0.80F, 0.47F, 0.65F},
                                               Colour{0.90F, 0.62F, 0.00F}, Colour{0.34F, 0.71F, 0.91F},
                                               Colour{0.35F, 0.35F, 0.35F}};
    return colours[index % colours.size()];
}

Canvas draw(const Plot& plot, int width, int height) {
    return Chart(plot, width, height).draw();
}

}  // namespace grapeshot::scenes
