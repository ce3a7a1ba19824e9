#include "wire.hpp"

#include <algorithm>
#include <cstring>

namespace grapeshot::import::detail {
namespace {

static_assert(sizeof(Eigen::Vector3f) == 12 && sizeof(Triangle) == 12);

class Writer {
  public:
    template <typename T>
    void put(const T& value) {
        putBytes(&value, sizeof value);
    }
    void putBytes(const void* data, std::size_t size) {
        if (size != 0) {
            const auto* first = static_cast<const std::byte*>(data);
            m_bytes.insert(m_bytes.end(), first, first + size);
        }
    }
    void reserve(std::size_t size) { m_bytes.reserve(size); }
    [[nodiscard]] std::vector<std::byte> take() { return std::move(m_bytes); }

  private:
    std::vector<std::byte> m_bytes;
};

class Reader {
  public:
    explicit Reader(std::span<const std::byte> bytes) : m_rest(bytes) {}
    template <typename T>
    bool get(T& value) {
        return getBytes(&value, sizeof value);
    }
    bool getBytes(void* data, std::size_t size) {
        if (size > m_rest.size()) {
            return false;
        }
        if (size != 0) {
            std::memcpy(data, m_rest.data(), size);
        }
        m_rest = m_rest.subspan(size);
        return true;
    }
    [[nodiscard]] std::size_t left() const { return m_rest.size(); }

  private:
    std::span<const std::byte> m_rest;
};

WireError malformed(const char* what) {
    return {Fault::badFile, std::string("the loader's answer is malformed: ") + what};
}

std::variant<scenes::Mesh, WireError> decodeMesh(Reader& reader) {
    std::uint64_t vertices = 0;
    std::uint64_t triangles = 0;
    if (!reader.get(vertices) || !reader.get(triangles)) {
        return malformed("no counts");
    }
    // Each count against the bytes that are there before they are multiplied: 2^63 * 12 would wrap.
    const std::size_t bytes = reader.left();
    if (vertices > bytes / 12 || triangles > bytes / 12 || 12 * (vertices + triangles) != bytes) {
        return malformed("counts and size disagree");
    }
    scenes::Mesh mesh;
    mesh.vertices.resize(vertices);
    mesh.triangles.resize(triangles);
    reader.getBytes(mesh.vertices.data(), 12 * vertices);
    reader.getBytes(mesh.triangles.data(), 12 * triangles);
    for (std::size_t t = 0; t < triangles; ++t) {
        for (const std::uint32_t index : mesh.triangles[t]) {
            if (index >= vertices) {
                return WireError{Fault::indexOutOfRange, "triangle " + std::to_string(t) + " names vertex " +
                                                             std::to_string(index) + " of " + std::to_string(vertices)};
            }
        }
    }
    return mesh;
}

std::variant<scenes::Mesh, WireError> decodeError(Reader& reader) {
    std::uint32_t fault = 0;
    std::uint32_t length = 0;
    if (!reader.get(fault) || !reader.get(length) || length != reader.left() || length > wireTextLimit ||
        fault > static_cast<std::uint32_t>(Fault::limitExceeded)) {
        return malformed("bad error record");
    }
    WireError error{static_cast<Fault>(fault), std::string(length, '\0')};
    reader.getBytes(error.text.data(), length);
    // The text quotes the file: no control characters on to a terminal.
    std::replace_if(
        error.text.begin(), error.text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, ' ');
    return error;
}

}  // namespace

std::vector<std::byte> encode(const scenes::Mesh& mesh) {
    Writer writer;
    writer.reserve(wireSize(mesh.vertices.size(), mesh.triangles.size()));
    writer.put(wireMagic);
    writer.put(wireMesh);
    writer.put(std::uint64_t{mesh.vertices.size()});
    writer.put(std::uint64_t{mesh.triangles.size()});
    writer.putBytes(mesh.vertices.data(), 12 * mesh.vertices.size());
    writer.putBytes(mesh.triangles.data(), 12 * mesh.triangles.size());
    return writer.take();
}

std::vector<std::byte> encode(const WireError& error) {
    const std::size_t length = std::min(error.text.size(), wireTextLimit);
    Writer writer;
    writer.put(wireMagic);
    writer.put(wireError);
    writer.put(static_cast<std::uint32_t>(error.fault));
    writer.put(static_cast<std::uint32_t>(length));
    writer.putBytes(error.text.data(), length);
    return writer.take();
}

std::variant<scenes::Mesh, WireError> decode(std::span<const std::byte> message) {
    Reader reader(message);
    std::uint32_t magic = 0;
    std::uint32_t kind = 0;
    if (!reader.get(magic) || !reader.get(kind) || magic != wireMagic) {
        return malformed("not a message");
    }
    if (kind == wireMesh) {
        return decodeMesh(reader);
    }
    return kind == wireError ? decodeError(reader) : malformed("unknown kind");
}

}  // namespace grapeshot::import::detail
