#include <report/report.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <report/machine.hpp>

namespace grapeshot::report {

namespace {

std::string formatted(double value, const char* format) {
    if (!std::isfinite(value)) {
        return "-";
    }
    char text[64];
    std::snprintf(text, sizeof text, format, value);
    return text;
}

std::string number(double value) {
    return std::isfinite(value) ? formatted(value, "%.9g") : "null";
}

std::string quoted(const std::string& text) {
    std::string result = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') {
            result += '\\';
            result += c;
        } else if (static_cast<unsigned char>(c) < 0x20) {
            char escaped[8];
            std::snprintf(escaped, sizeof escaped, "\\u%04x", static_cast<unsigned>(c));
            result += escaped;
        } else {
            result += c;
        }
    }
    return result + '"';
}

std::string object(const NamedNumbers& numbers) {
    std::string text = "{";
    for (const auto& [name, value] : numbers) {
        text += (text.size() > 1 ? ", " : "") + quoted(name) + ": " + number(value);
    }
    return text + "}";
}

std::string object(const NamedCurves& curves) {
    std::string text = "{";
    for (const auto& [name, values] : curves) {
        text += (text.size() > 1 ? ", " : "") + quoted(name) + ": [";
        for (std::size_t i = 0; i < values.size(); ++i) {
            text += (i > 0 ? ", " : "") + number(values[i]);
        }
        text += "]";
    }
    return text + "}";
}

NamedNumbers named(const Quantiles& q) {
    return {{"p50", q.p50}, {"p95", q.p95}, {"p99", q.p99}, {"max", q.max}, {"mean", q.mean}};
}

std::string json(const Row& row) {
    return "{\"scenario\": " + quoted(row.scenario) + ", \"mesh\": " + quoted(row.mesh) +
           ", \"triangles\": " + std::to_string(row.triangles) + ", \"method\": " + quoted(row.method) +
           ", \"peer\": " + quoted(row.peer) + ", \"n\": " + std::to_string(row.n) +
           ", \"falseNegatives\": " + number(row.falseNegatives) +
           ", \"falsePositives\": " + number(row.falsePositives) + ", \"colliding\": " + number(row.colliding) +
           ", \"timeUs\": " + object(named(row.timeUs)) + ", \"work\": " + object(row.work) +
           ", \"measured\": " + object(row.measured) + ", \"curves\": " + object(row.curves) +
           ", \"ratio\": " + number(row.ratio) + "}";
}

/// Cells of one row: name of the column and text.
std::vector<std::pair<std::string, std::string>> cells(const Row& row) {
    std::vector<std::pair<std::string, std::string>> result{
        {"scenario", row.scenario}, {"mesh", row.mesh}, {"triangles", std::to_string(row.triangles)},
        {"method", row.method},     {"peer", row.peer}, {"n", std::to_string(row.n)}};
    const auto add = [&](const std::string& name, double value, const char* format = "%.4g") {
        if (std::isfinite(value)) {
            result.emplace_back(name, formatted(value, format));
        }
    };
    add("colliding", row.colliding, "%.0f");
    add("FN", row.falseNegatives, "%.0f");
    add("FP", row.falsePositives, "%.0f");
    add("mean us", row.timeUs.mean);
    add("p50", row.timeUs.p50);
    add("p99", row.timeUs.p99);
    add("max", row.timeUs.max);
    add("ratio", row.ratio, "%.1f");
    for (const NamedNumbers* numbers : {&row.work, &row.measured}) {
        for (const auto& [name, value] : *numbers) {
            add(name, value);
        }
    }
    return result;
}

}  // namespace

namespace {

double nearestRank(const std::vector<double>& sorted, double q) {
    const auto i = static_cast<std::size_t>(std::ceil(q * static_cast<double>(sorted.size())));
    return sorted[std::clamp<std::size_t>(i, 1, sorted.size()) - 1];
}

}  // namespace

double quantile(std::vector<double> values, double q) {
    if (values.empty()) {
        return notApplicable;
    }
    std::ranges::sort(values);
    return nearestRank(values, q);
}

double mean(const std::vector<double>& values) {
    double sum = 0;
    for (const double value : values) {
        sum += value;
    }
    return values.empty() ? notApplicable : sum / static_cast<double>(values.size());
}

double geometricMean(const std::vector<double>& values) {
    double sum = 0;
    for (const double value : values) {
        sum += std::log(value);
    }
    return values.empty() ? notApplicable : std::exp(sum / static_cast<double>(values.size()));
}

Quantiles quantiles(std::vector<double> values) {
    if (values.empty()) {
        return {};
    }
    std::ranges::sort(values);
    const auto rank = [&](double q) { return nearestRank(values, q); };
    return {rank(0.5), rank(0.95), rank(0.99), values.back(), mean(values)};
}

double median(std::vector<double> values) {
    if (values.empty()) {
        return notApplicable;
    }
    std::ranges::sort(values);
    const std::size_t half = values.size() / 2;
    return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
}

double spread(const std::vector<double>& values) {
    if (values.empty()) {
        return notApplicable;
    }
    const auto [low, high] = std::ranges::minmax(values);
    return high / low - 1;
}

bool Report::holds() const {
    return std::ranges::all_of(claims, &Claim::holds);
}

std::string table(const Report& report) {
    // Columns in order of first appearance; a row of another kind simply leaves them empty.
    std::vector<std::string> columns;
    std::vector<std::vector<std::pair<std::string, std::string>>> lines;
    for (const Row& row : report.rows) {
        lines.push_back(cells(row));
        for (const auto& [name, text] : lines.back()) {
            if (std::ranges::find(columns, name) == columns.end()) {
                columns.push_back(name);
            }
        }
    }
    const auto cell = [](const auto& line, const std::string& name) {
        const auto found = std::ranges::find(line, name, [](const auto& c) { return c.first; });
        return found == line.end() ? std::string() : found->second;
    };
    std::string text;
    std::vector<std::size_t> widths;
    for (const std::string& name : columns) {
        std::size_t width = name.size();
        for (const auto& line : lines) {
            width = std::max(width, cell(line, name).size());
        }
        widths.push_back(width);
        text += std::string(width - name.size(), ' ') + name + "  ";
    }
    text += '\n';
    for (const auto& line : lines) {
        for (std::size_t c = 0; c < columns.size(); ++c) {
            const std::string content = cell(line, columns[c]);
            text += std::string(widths[c] - content.size(), ' ') + content + "  ";
        }
        text += '\n';
    }
    text += '\n';
    for (const Claim& claim : report.claims) {
        text += std::string(claim.holds() ? "  ok      " : "  FAILED  ") + claim.claim + ": " +
                formatted(claim.value, "%.4g") + (claim.atLeast ? " >= " : " <= ") + formatted(claim.bound, "%.4g") +
                '\n';
    }
    return text;
}

std::string json(const Report& report) {
    const Machine here = machine();
    std::string text = "{\"suite\": " + quoted(report.suite) + ", \"commit\": " + quoted(here.commit) +
                       ", \"cpu\": " + quoted(here.cpu) + ", \"isa\": " + quoted(here.isa) +
                       ", \"compiler\": " + quoted(here.compiler) + ", \"seed\": " + std::to_string(report.seed) +
                       ", \"quick\": " + (report.quick ? "true" : "false") + ",\n \"rows\": [";
    for (std::size_t i = 0; i < report.rows.size(); ++i) {
        text += (i == 0 ? "\n  " : ",\n  ") + json(report.rows[i]);
    }
    text += "],\n \"claims\": [";
    for (std::size_t i = 0; i < report.claims.size(); ++i) {
        const Claim& claim = report.claims[i];
        text += std::string(i == 0 ? "\n  " : ",\n  ") + "{\"claim\": " + quoted(claim.claim) +
                ", \"value\": " + number(claim.value) + ", \"relation\": " + (claim.atLeast ? "\">=\"" : "\"<=\"") +
                ", \"bound\": " + number(claim.bound) + ", \"holds\": " + (claim.holds() ? "true" : "false") + "}";
    }
    return text + "]}\n";
}

}  // namespace grapeshot::report
