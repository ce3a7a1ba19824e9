#include <grapeshot/adb/calibration.hpp>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <limits>
#include <sstream>
#include <vector>

#include <grapeshot/adb/detail/default_calibration.hpp>
#include <grapeshot/core/error.hpp>

namespace grapeshot {
namespace {

constexpr int firstOctave = -10;
constexpr int knotsPerOctave = 2;
constexpr std::uint32_t mantissaBits = 23;
constexpr std::int32_t exponentOfOne = 127;
constexpr std::string_view title = "grapeshot calibration";

/// Number of knots before a rate: linear in the rate between knots, from its bits, so the same bytes everywhere and far
/// quicker than a logarithm.
float placeOf(float rate) noexcept {
    const auto bits = std::bit_cast<std::int32_t>(std::max(rate, std::numeric_limits<float>::min()));
    constexpr std::int32_t first = (exponentOfOne + firstOctave) << mantissaBits;
    return static_cast<float>(bits - first) * (static_cast<float>(knotsPerOctave) / (1U << mantissaBits));
}

float interpolated(const Calibration::Row& row, float rate) noexcept {
    const float inside = std::clamp(placeOf(rate), 0.0F, static_cast<float>(Calibration::knots - 1));
    const auto before = std::min(static_cast<std::size_t>(inside), Calibration::knots - 2);
    const float share = inside - static_cast<float>(before);
    return row[before] + share * (row[before + 1] - row[before]);  // equal knots: exactly theirs
}

float rateAt(double place) noexcept {
    const double octave = std::floor(place / knotsPerOctave);
    return static_cast<float>(std::ldexp(1 + place / knotsPerOctave - octave, firstOctave + static_cast<int>(octave)));
}

/// Reads a text line by line, and says where it stopped making sense.
class Reader {
  public:
    Reader(std::string_view text, const std::string& source) : m_rest(text), m_source(source) {}

    /// Of the next line that is not empty, what comes after `key`.
    std::string_view after(std::string_view key) {
        const std::string_view line = next();
        if (!line.starts_with(key)) {
            fail("'" + std::string(line.substr(0, 40)) + "' where '" + std::string(key) + "' should be");
        }
        std::string_view value = line.substr(key.size());
        value.remove_prefix(std::min(value.find_first_not_of(' '), value.size()));
        return value;
    }

    std::vector<float> numbers(std::string_view key, std::size_t count) {
        std::string_view rest = after(key);
        std::vector<float> values;
        while (!rest.empty()) {
            float value = 0;
            const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
            if (error != std::errc() || !std::isfinite(value)) {
                fail("'" + std::string(rest.substr(0, rest.find(' '))) + "' is no number");
            }
            values.push_back(value);
            rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
            rest.remove_prefix(std::min(rest.find_first_not_of(' '), rest.size()));
        }
        if (values.size() != count) {
            fail(std::to_string(values.size()) + " numbers where " + std::to_string(count) + " should be");
        }
        return values;
    }

    Calibration::Row probabilities(std::string_view key) {
        const std::vector<float> values = numbers(key, Calibration::knots);
        Calibration::Row row{};
        for (std::size_t i = 0; i < row.size(); ++i) {
            if (!(values[i] >= 0 && values[i] <= 1)) {
                fail(std::to_string(values[i]) + " is no probability");
            }
            if (i > 0 && values[i] < values[i - 1]) {
                fail("probability " + std::to_string(values[i]) + " after " + std::to_string(values[i - 1]) +
                     ": they must not fall");
            }
            row[i] = values[i];
        }
        return row;
    }

    void end() {
        if (!m_rest.empty() && m_rest.find_first_not_of(" \r\n") != std::string_view::npos) {
            static_cast<void>(next());
            fail("more than there should be");
        }
    }

    [[noreturn]] void fail(const std::string& what) const {
        throw Error(Fault::badFile, what, m_source + ":" + std::to_string(m_line));
    }

  private:
    std::string_view next() {
        while (!m_rest.empty()) {
            const std::size_t end = m_rest.find('\n');
            std::string_view line = m_rest.substr(0, end);
            m_rest.remove_prefix(end == std::string_view::npos ? m_rest.size() : end + 1);
            ++m_line;
            if (line.ends_with('\r')) {
                line.remove_suffix(1);
            }
            if (!line.empty()) {
                return line;
            }
        }
        ++m_line;
        fail("the text ends here");
    }

    std::string_view m_rest;
    std::string m_source;
    int m_line = 0;
};

}  // namespace

const Calibration& defaultCalibration() {
    static const Calibration calibration = calibrationFrom(detail::defaultCalibrationText, "default calibration");
    return calibration;
}

float probabilityOfWholes(const Calibration& calibration, float squaredDistance) noexcept {
    return interpolated(calibration.whole, 1 / (squaredDistance * squaredDistance));
}

float probabilityAfter(const Calibration& calibration, float rate, std::uint64_t steps) noexcept {
    return interpolated(calibration.bySteps[Calibration::rowOf(steps)], rate);
}

float probabilityAfterwards(const Calibration& calibration, float rate, std::uint64_t exactSteps) noexcept {
    const auto row = static_cast<std::size_t>(std::bit_width(exactSteps / 4));
    return interpolated(calibration.afterwards[std::min(row, Calibration::afterRows - 1)], rate);
}

float probabilityOfRegion(const Calibration& calibration, float rate, std::uint64_t steps) noexcept {
    return interpolated(calibration.regions[Calibration::regionRowOf(steps)], rate);
}

float knotRate(std::size_t knot) noexcept {
    return rateAt(static_cast<double>(knot));
}

float leastRateAt(const Calibration::Row& row, float probability) noexcept {
    const auto after = std::lower_bound(row.begin(), row.end(), probability);
    if (after == row.end()) {
        return std::numeric_limits<float>::infinity();
    }
    if (after == row.begin()) {
        return 0;
    }
    const double before = *(after - 1);
    return rateAt(static_cast<double>(after - row.begin()) - 1 + (probability - before) / (*after - before));
}

float mostRateAt(const Calibration::Row& row, float probability) noexcept {
    const auto after = std::upper_bound(row.begin(), row.end(), probability);
    if (after == row.begin()) {
        return -1;
    }
    if (after == row.end()) {
        return std::numeric_limits<float>::infinity();
    }
    const double before = *(after - 1);
    return rateAt(static_cast<double>(after - row.begin()) - 1 + (probability - before) / (*after - before));
}

std::string toText(const Calibration& calibration) {
    std::ostringstream out;
    const auto number = [&out](float value) {
        char digits[32];
        out << ' ' << std::string_view(digits, std::to_chars(digits, digits + sizeof(digits), value).ptr);
    };
    out << title << ' ' << Calibration::version << '\n';
    out << "poses " << calibration.poses << '\n';
    out << "formula";
    number(calibration.formula.constant);
    number(calibration.formula.distance);
    number(calibration.formula.length);
    out << '\n';
    const auto rows = [&](std::string_view key, const auto& table) {
        for (const Calibration::Row& row : table) {
            out << key;
            std::for_each(row.begin(), row.end(), number);
            out << '\n';
        }
    };
    rows("whole", std::array<Calibration::Row, 1>{calibration.whole});
    rows("steps", calibration.bySteps);
    rows("afterwards", calibration.afterwards);
    rows("regions", calibration.regions);
    return out.str();
}

Calibration calibrationFrom(std::string_view text, const std::string& source) {
    Reader reader(text, source);
    const std::string_view version = reader.after(title);
    if (version != std::to_string(Calibration::version)) {
        reader.fail("version '" + std::string(version.substr(0, 20)) + "', not " +
                    std::to_string(Calibration::version));
    }
    Calibration out;
    out.poses = reader.after("poses");
    const std::vector<float> formula = reader.numbers("formula", 3);
    out.formula = {formula[0], formula[1], formula[2]};
    out.whole = reader.probabilities("whole");
    for (Calibration::Row& row : out.bySteps) {
        row = reader.probabilities("steps");
    }
    for (Calibration::Row& row : out.afterwards) {
        row = reader.probabilities("afterwards");
    }
    for (Calibration::Row& row : out.regions) {
        row = reader.probabilities("regions");
    }
    reader.end();
    return out;
}

}  // namespace grapeshot
