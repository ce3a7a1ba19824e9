// What the loading process says to its parent: one message, a mesh or an error, in the machine's own byte order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include <grapeshot/core/error.hpp>
#include <scenes/shapes.hpp>

namespace grapeshot::import::detail {

struct WireError {
    Fault fault = Fault::badFile;
    std::string text;
};

inline constexpr std::uint32_t wireMagic = 0x31495347;  // "GSI1"
inline constexpr std::uint32_t wireMesh = 1;
inline constexpr std::uint32_t wireError = 2;
inline constexpr std::size_t wireTextLimit = 2000;  // bytes of an error text; the rest is cut

/// Bytes of a message with these counts: what the parent is ready to read at most.
[[nodiscard]] constexpr std::size_t wireSize(std::size_t vertices, std::size_t triangles) {
    return 24 + 12 * vertices + 12 * triangles;
}

[[nodiscard]] std::vector<std::byte> encode(const scenes::Mesh& mesh);
[[nodiscard]] std::vector<std::byte> encode(const WireError& error);

/// Reads nothing beyond the end, believes no count. A malformed message is a WireError that says so.
[[nodiscard]] std::variant<scenes::Mesh, WireError> decode(std::span<const std::byte> message);

}  // namespace grapeshot::import::detail
