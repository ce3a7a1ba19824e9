// A small font of pen strokes, so that pictures need no font file.
#pragma once

#include <Eigen/Core>
#include <string_view>
#include <vector>

namespace grapeshot::scenes {

/// Strokes of one character for a cap height of 1: x to the right from 0, y up from the baseline.
struct Glyph {
    std::vector<std::vector<Eigen::Vector2d>> strokes;
    double advance = 0;  ///< to the next character
};

/// Printable ASCII; anything else is an empty box.
[[nodiscard]] Glyph glyph(char character);

/// Width of a line of text for a cap height of 1.
[[nodiscard]] double textWidth(std::string_view text);

}  // namespace grapeshot::scenes
