#include <grapeshot/scf/detail/tracker_file.hpp>

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <string>
#include <type_traits>
#include <utility>

#include <xxhash.h>

#include <grapeshot/core/error.hpp>
#include <grapeshot/scf/detail/front_file.hpp>

namespace grapeshot::detail {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::array<char, 8> magic{'G', 'S', 'T', 'R', 'A', 'C', 'K', '\n'};
constexpr std::uint32_t version = 2;

/// Then as many SavedPairs, then the front. No padding, so that its bytes may be hashed.
struct Header {
    std::array<char, 8> title = magic;
    std::uint32_t format = version;
    std::uint32_t isSelf = 0;
    ContentKey a, b;
    std::uint64_t step = 0;
    float testPrice = 0;
    std::uint32_t nothing = 0;
    std::uint64_t pairs = 0;
    std::uint64_t hash = 0;  ///< of all else
};
static_assert(sizeof(Header) == 80 && std::is_trivially_copyable_v<Header>);

struct SavedPair {
    std::uint32_t triangleA, triangleB;
    std::uint64_t birth;
};
static_assert(sizeof(SavedPair) == 16);

/// @pre the header's own hash is 0
std::uint64_t hashOf(const Header& header, std::span<const std::byte> rest) {
    return XXH3_64bits_withSeed(rest.data(), rest.size(), XXH3_64bits(&header, sizeof header));
}

[[noreturn]] void fail(Fault fault, const std::string& what) {
    throw Error(fault, what, "Tracker::load");
}

}  // namespace

std::vector<std::byte> savedMemory(const TrackerMemory& memory, const TrackedTrees& trees) {
    Header header;
    header.isSelf = trees.oneBody ? 1 : 0;
    header.a = trees.a.surface.topology;
    header.b = trees.b.surface.topology;
    header.step = memory.step;
    header.testPrice = memory.testPrice;
    header.pairs = memory.tracked.size();
    std::vector<std::byte> bytes(sizeof header + memory.tracked.size() * sizeof(SavedPair));
    std::byte* to = bytes.data() + sizeof header;
    for (const TrackedPair& tracked : memory.tracked) {
        const SavedPair saved{tracked.pair.triangleA, tracked.pair.triangleB, tracked.birth};
        std::memcpy(to, &saved, sizeof saved);
        to += sizeof saved;
    }
    ByteWriter writer(bytes);
    putFront(memory.front, writer);
    header.hash = hashOf(header, std::span(bytes).subspan(sizeof header));
    std::memcpy(bytes.data(), &header, sizeof header);
    return bytes;
}

TrackerMemory loadedMemory(std::span<const std::byte> bytes, const TrackedTrees& trees) {
    const auto& [a, b, oneBody] = trees;
    Header header;
    if (bytes.size() < sizeof header) {
        fail(Fault::badFile, std::to_string(bytes.size()) + " bytes are too few");
    }
    std::memcpy(&header, bytes.data(), sizeof header);
    if (header.title != magic || header.format != version) {
        fail(Fault::badFile, "no state of a tracker, or of another version");
    }
    const std::span<const std::byte> pairs = bytes.subspan(sizeof header);
    if (pairs.size() / sizeof(SavedPair) < header.pairs) {
        fail(Fault::badFile,
             std::to_string(bytes.size()) + " bytes are too few for " + std::to_string(header.pairs) + " pairs");
    }
    const std::uint64_t hash = std::exchange(header.hash, 0);
    if (hash != hashOf(header, pairs)) {
        fail(Fault::badFile, "was changed since it was saved");
    }
    if ((header.isSelf != 0) != oneBody || !(header.a == a.surface.topology) || !(header.b == b.surface.topology)) {
        fail(Fault::topologyChanged, "saved with other meshes");
    }
    TrackerMemory memory;
    memory.step = header.step;
    memory.testPrice = header.testPrice;
    if (!(memory.testPrice >= 0) || !std::isfinite(memory.testPrice)) {
        fail(Fault::badFile, "a price is no number");
    }
    memory.tracked.reserve(header.pairs);
    for (std::size_t i = 0; i < header.pairs; ++i) {
        SavedPair saved;
        std::memcpy(&saved, pairs.data() + i * sizeof saved, sizeof saved);
        if (saved.triangleA >= a.surface.triangles.size() || saved.triangleB >= b.surface.triangles.size() ||
            saved.birth > memory.step) {
            fail(Fault::badFile, "pair " + std::to_string(i) + " is out of range");
        }
        memory.tracked.push_back({{saved.triangleA, saved.triangleB}, saved.birth});
    }
    ByteReader reader(pairs.subspan(header.pairs * sizeof(SavedPair)), "Tracker::load");
    memory.front = frontFrom(reader, trees);
    reader.require(reader.left() == 0, "bytes left over");
    return memory;
}

}  // namespace grapeshot::detail
