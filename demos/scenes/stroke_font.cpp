#include "stroke_font.hpp"

#include <algorithm>
#include <array>

namespace grapeshot::scenes {

namespace {

// One string per character from '!' on. A stroke is a row of points, two hexadecimal digits each: x, and y with the
// baseline at 3, small letters up to b, capitals up to f. '~' before a stroke rounds its corners.
constexpr std::array<std::string_view, 94> strokesOf{
    "0f06 0403",                             // !
    "0c0f 3c3f",                             // "
    "123f 526f 0676 0b7b",                   // #
    "~6c6e3e0e09396964340406 3f32",          // $
    "036f ~1f0f0c1c2c2f1f ~56464353636656",  // %
    "~83491c1f3f5f5c0903033378",             // &
    "0c0f",                                  // '
    "~3f0c0431",                             // (
    "~0f3c3401",                             // )
    "3c36 0b67 0767 6b07",                   // *
    "0868 353b",                             // +
    "1400",                                  // ,
    "0858",                                  // -
    "0304",                                  // .
    "026f",                                  // /
    "~3f0f0333636f3f",                       // 0
    "0c3f33",                                // 1
    "~0c0f3f6f6a03 0363",                    // 2
    "~0d0f3f6f6939 ~396963330305",           // 3
    "535f0777",                              // 4
    "6f0f0a ~0a3b6b63330305",                // 5
    "~6e6f3f0f0333636a3a0a06",               // 6
    "0f6f23",                                // 7
    "~3f0f0939696f3f ~39090333636939",       // 8
    "~040333636f3f0f0838686c",               // 9
    "0304 0a0b",                             // :
    "1400 1a1b",                             // ;
    "6b0763",                                // <
    "0666 0a6a",                             // =
    "0b6703",                                // >
    "~0c0f3f6f6a3936 3433",                  // ?
    "~6858584b4858686f6f3f0f0333636374",     // @
    "034f83 1676",                           // A
    "030f ~0f5f8f895909 ~095989835303",      // B
    "~8d8f4f0f03438385",                     // C
    "030f ~0f4f8f834303",                    // D
    "7f0f0373 0959",                         // E
    "7f0f03 0959",                           // F
    "~8d8f4f0f034383 838959",                // G
    "030f 838f 0989",                        // H
    "030f",                                  // I
    "~6f6663330306",                         // J
    "030f 7f08 2a83",                        // K
    "0f0373",                                // L
    "030f478f83",                            // M
    "030f838f",                              // N
    "~4f0f0343838f4f",                       // O
    "030f ~0f5f8f885808",                    // P
    "~4f0f0343838f4f 5783",                  // Q
    "030f ~0f5f8f885808 4883",               // R
    "~8d8f4f0f09498983430305",               // S
    "0f8f 4f43",                             // T
    "~0f07034383878f",                       // U
    "0f438f",                                // V
    "0f335c73af",                            // W
    "038f 0f83",                             // X
    "0f498f 4943",                           // Y
    "0f8f0383",                              // Z
    "3f0f0131",                              // [
    "0f62",                                  // backslash
    "0f3f3101",                              // ]
    "0b3f6b",                                // ^
    "0282",                                  // _
    "0f2d",                                  // `
    "6b63 ~696b3b0b03336365",                // a
    "0f03 ~090b3b6b63330305",                // b
    "~6a6b3b0b03336364",                     // c
    "6f63 ~696b3b0b03336365",                // d
    "0767 ~676b3b0b03336365",                // e
    "~5f2f2c23 0b4b",                        // f
    "~696b3b0b03336365 ~6b6360300001",       // g
    "0f03 ~080b3b6b6763",                    // h
    "0b03 0e0f",                             // i
    "~2b212000 2e2f",                        // j
    "0f03 6b06 2863",                        // k
    "0f03",                                  // l
    "0b03 ~080b3b5b5753 ~585b8baba7a3",      // m
    "0b03 ~080b3b6b6763",                    // n
    "~3b0b0333636b3b",                       // o
    "0b00 ~090b3b6b63330305",                // p
    "6b60 ~696b3b0b03336365",                // q
    "0b03 ~080b4b",                          // r
    "~5a5b3b0b07275753230304",               // s
    "~2f242353 0b5b",                        // t
    "6b63 ~0b0703336366",                    // u
    "0b336b",                                // v
    "0b234a638b",                            // w
    "036b 0b63",                             // x
    "0b33 6b3320",                           // y
    "0b6b0363",                              // z
    "~3f2f2908282131",                       // {
    "010f",                                  // |
    "~0f1f1938181101",                       // }
    "~080a2a38587a",                         // ~
};

constexpr double unit = 1.0 / 12;  // of the cap height

double digit(char c) {
    return c <= '9' ? c - '0' : c - 'a' + 10;
}

/// Chaikin's corner cutting; the ends stay.
std::vector<Eigen::Vector2d> rounded(std::vector<Eigen::Vector2d> stroke) {
    for (int pass = 0; pass < 3; ++pass) {
        std::vector<Eigen::Vector2d> finer{stroke.front()};
        for (std::size_t i = 0; i + 1 < stroke.size(); ++i) {
            const Eigen::Vector2d step = stroke[i + 1] - stroke[i];
            if (i > 0) {
                finer.push_back(stroke[i] + 0.25 * step);
            }
            if (i + 2 < stroke.size()) {
                finer.push_back(stroke[i] + 0.75 * step);
            }
        }
        finer.push_back(stroke.back());
        stroke = std::move(finer);
    }
    return stroke;
}

}  // namespace

Glyph glyph(char character) {
    Glyph result;
    if (character == ' ') {
        result.advance = 6 * unit;
        return result;
    }
    const bool known = character > ' ' && character <= '~';
    std::string_view text = known ? strokesOf[static_cast<std::size_t>(character - '!')] : "030f6f6303";
    double width = 0;
    while (!text.empty()) {
        std::string_view stroke = text.substr(0, text.find(' '));
        text.remove_prefix(std::min(text.size(), stroke.size() + 1));
        const bool round = stroke.front() == '~';
        stroke.remove_prefix(round ? 1 : 0);
        std::vector<Eigen::Vector2d> points;
        for (std::size_t i = 0; i + 1 < stroke.size(); i += 2) {
            points.emplace_back(digit(stroke[i]) * unit, (digit(stroke[i + 1]) - 3) * unit);
            width = std::max(width, points.back().x());
        }
        result.strokes.push_back(round ? rounded(std::move(points)) : std::move(points));
    }
    result.advance = width + 3.2 * unit;
    return result;
}

double textWidth(std::string_view text) {
    double width = 0;
    for (const char c : text) {
        width += glyph(c).advance;
    }
    return width;
}

}  // namespace grapeshot::scenes
