#include "header_check.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstring>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include <grapeshot/core/error.hpp>

namespace grapeshot::import::detail {
namespace {

constexpr std::size_t longestLine = 1U << 16U;  // a header line beyond this is no header

/// Lines of a text file, counted; stops at lines that are no text.
class Lines {
  public:
    explicit Lines(const std::filesystem::path& file) : m_file(file), m_stream(file, std::ios::binary) {}

    /// Next line without its end; false at the end of the file.
    bool next() {
        m_line.clear();
        ++m_number;
        char c = 0;
        bool any = false;
        while (m_stream.get(c)) {
            any = true;
            if (c == '\n') {
                break;
            }
            if (m_line.size() < longestLine) {
                m_line.push_back(c);
            }
        }
        while (!m_line.empty() && (m_line.back() == '\r' || m_line.back() == ' ')) {
            m_line.pop_back();
        }
        return any;
    }
    /// Next line that is neither blank nor a comment.
    bool nextData() {
        while (next()) {
            const std::size_t first = m_line.find_first_not_of(" \t");
            if (first != std::string::npos && m_line[first] != '#') {
                return true;
            }
        }
        return false;
    }
    [[nodiscard]] const std::string& line() const { return m_line; }
    [[nodiscard]] std::uintmax_t offset() { return static_cast<std::uintmax_t>(m_stream.tellg()); }
    bool readBytes(void* data, std::size_t size) {
        return static_cast<bool>(m_stream.read(static_cast<char*>(data), static_cast<std::streamsize>(size)));
    }

    [[noreturn]] void fail(Fault fault, const std::string& what) const {
        throw Error(fault, what, m_file.string() + ":" + std::to_string(m_number));
    }

  private:
    std::filesystem::path m_file;
    std::ifstream m_stream;
    std::string m_line;
    std::size_t m_number = 0;
};

std::vector<std::string_view> words(std::string_view line) {
    std::vector<std::string_view> result;
    for (std::size_t at = 0; at < line.size();) {
        const std::size_t begin = line.find_first_not_of(" \t", at);
        if (begin == std::string_view::npos) {
            break;
        }
        const std::size_t end = std::min(line.find_first_of(" \t", begin), line.size());
        result.push_back(line.substr(begin, end - begin));
        at = end;
    }
    return result;
}

std::uintmax_t count(const Lines& lines, std::string_view word) {
    std::uintmax_t value = 0;
    const auto [end, fault] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (fault != std::errc{} || end != word.data() + word.size()) {
        lines.fail(Fault::badFile, "the header's count '" + std::string(word.substr(0, 40)) + "' is no number");
    }
    return value;
}

/// `rows` of at least `rowBytes` each must fit into `bytes`.
void requireRoom(const Lines& lines, const std::string& what, std::uintmax_t rows, std::uintmax_t rowBytes,
                 std::uintmax_t bytes) {
    if (rowBytes != 0 && rows > bytes / rowBytes) {
        lines.fail(Fault::badFile, "the header claims " + std::to_string(rows) + " " + what + ", for which " +
                                       std::to_string(bytes) + " bytes have no room (cut off, or not what it says)");
    }
}

void requireLines(Lines& lines, std::uintmax_t rows) {
    for (std::uintmax_t row = 0; row < rows; ++row) {
        if (!lines.nextData()) {
            lines.fail(Fault::badFile, "cut off: the header promises " + std::to_string(rows) + " lines, there are " +
                                           std::to_string(row));
        }
    }
}

void checkOff(Lines& lines, std::uintmax_t fileBytes) {
    std::vector<std::string_view> found = words(lines.line());
    if (std::find(found.begin(), found.end(), "BINARY") != found.end()) {
        unsigned char raw[8] = {};
        lines.readBytes(raw, sizeof raw);
        const auto bigEndian = [&](int at) {
            return (std::uintmax_t{raw[at]} << 24U) | (std::uintmax_t{raw[at + 1]} << 16U) |
                   (std::uintmax_t{raw[at + 2]} << 8U) | raw[at + 3];
        };
        requireRoom(lines, "vertices", bigEndian(0), 12, fileBytes);
        requireRoom(lines, "faces", bigEndian(4), 4, fileBytes);
        return;
    }
    if (found.size() < 3) {  // the counts have a line of their own
        if (!lines.nextData()) {
            lines.fail(Fault::badFile, "cut off: no counts");
        }
        found = words(lines.line());
    } else {
        found.erase(found.begin());
    }
    if (found.size() < 2) {
        lines.fail(Fault::badFile, "no counts of vertices and faces");
    }
    const std::uintmax_t vertices = count(lines, found[0]);
    const std::uintmax_t faces = count(lines, found[1]);
    requireRoom(lines, "vertices", vertices, 6, fileBytes);  // "0 0 0\n"
    requireRoom(lines, "faces", faces, 4, fileBytes);        // "1 0\n"
    requireLines(lines, vertices);
    for (std::uintmax_t face = 0; face < faces; ++face) {
        requireLines(lines, 1);
        if (lines.line().find('-') != std::string::npos) {
            lines.fail(Fault::indexOutOfRange, "face " + std::to_string(face) + " has a negative index");
        }
    }
}

/// Bytes of a PLY scalar in a binary file; 0 if there is no such type.
std::uintmax_t plyScalarBytes(std::string_view type) {
    struct Known {
        std::string_view name;
        std::uintmax_t bytes;
    };
    static constexpr Known known[] = {
        {"char", 1},  {"uchar", 1},   {"int8", 1},   {"uint8", 1},   {"short", 2}, {"ushort", 2},
        {"int16", 2}, {"uint16", 2},  {"int", 4},    {"uint", 4},    {"int32", 4}, {"uint32", 4},
        {"float", 4}, {"float32", 4}, {"double", 8}, {"float64", 8},
    };
    const auto* const found =
        std::find_if(std::begin(known), std::end(known), [&](const Known& k) { return k.name == type; });
    return found == std::end(known) ? 0 : found->bytes;
}

void checkPly(Lines& lines, std::uintmax_t fileBytes) {
    struct Element {
        std::string name;
        std::uintmax_t rows = 0;
        std::uintmax_t rowBytes = 0;  ///< at least
    };
    std::vector<Element> elements;
    bool text = false;
    for (;;) {
        if (!lines.next()) {
            lines.fail(Fault::badFile, "cut off within the header");
        }
        const std::vector<std::string_view> found = words(lines.line());
        if (found.empty()) {
            continue;
        }
        if (found[0] == "end_header") {
            break;
        }
        if (found[0] == "format" && found.size() > 1) {
            text = found[1] == "ascii";
        } else if (found[0] == "element" && found.size() > 2) {
            elements.push_back({std::string(found[1].substr(0, 40)), count(lines, found[2]), 0});
        } else if (found[0] == "property" && found.size() > 1 && !elements.empty()) {
            // A list has at least its length; in a text file a value has at least a digit and a separator.
            const std::string_view type = found[1] == "list" && found.size() > 2 ? found[2] : found[1];
            elements.back().rowBytes += text ? 2 : plyScalarBytes(type);
        }
    }
    std::uintmax_t left = fileBytes - std::min(lines.offset(), fileBytes);
    std::uintmax_t rows = 0;
    for (const Element& element : elements) {
        // The last row of a text file may lack its line end.
        requireRoom(lines, "rows of '" + element.name + "'", element.rows, element.rowBytes, left + 1);
        left -= std::min(left, element.rows * element.rowBytes);
        rows += element.rows;
    }
    if (text) {
        requireLines(lines, rows);
    }
}

void checkBinaryStl(Lines& lines, std::uintmax_t fileBytes, const std::uint8_t* head) {
    std::uint32_t triangles = 0;
    std::memcpy(&triangles, head + 80, sizeof triangles);
    requireRoom(lines, "triangles", triangles, 50, fileBytes - 84);
}

bool isOff(std::string_view keyword) {
    static constexpr std::string_view prefixes[] = {"",   "C",   "N",  "CN",  "4",   "C4",
                                                    "N4", "CN4", "ST", "STC", "STN", "STCN"};
    return keyword.ends_with("OFF") && std::find(std::begin(prefixes), std::end(prefixes),
                                                 keyword.substr(0, keyword.size() - 3)) != std::end(prefixes);
}

}  // namespace

void checkHeader(const std::filesystem::path& file, std::uintmax_t fileBytes) {
    std::string extension = file.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return std::tolower(c); });
    Lines lines(file);
    if (extension == ".stl") {
        std::uint8_t head[84] = {};
        if (fileBytes >= sizeof head && lines.readBytes(head, sizeof head) && std::memcmp(head, "solid", 5) != 0) {
            checkBinaryStl(lines, fileBytes, head);
        }
        return;
    }
    if (extension != ".off" && extension != ".ply") {
        return;
    }
    if (!lines.nextData()) {
        lines.fail(Fault::emptyMesh, "the file is empty");
    }
    const std::vector<std::string_view> first = words(lines.line());
    if (first[0] == "ply") {
        checkPly(lines, fileBytes);
    } else if (isOff(first[0])) {
        checkOff(lines, fileBytes);
    } else {
        lines.fail(Fault::badFile, "not a" + std::string(extension == ".off" ? "n OFF" : " PLY") + " file");
    }
}

}  // namespace grapeshot::import::detail
