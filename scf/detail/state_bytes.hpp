// The frame of saved states: what they are, of which meshes, and a hash of all.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <xxhash.h>

#include <grapeshot/core/bytes.hpp>
#include <grapeshot/scf/ball_tree.hpp>

namespace grapeshot::detail {

/// @param magic tells one kind of state, and its version, from the others
/// @param put (ByteWriter&): the state itself
template <class Put>
[[nodiscard]] std::vector<std::byte> sealedState(std::uint64_t magic, const BallTree& a, const BallTree& b, Put&& put) {
    std::vector<std::byte> bytes;
    ByteWriter writer(bytes);
    writer.put(magic);
    writer.put(static_cast<std::uint8_t>(&a == &b ? 1 : 0));
    for (const BallTree* tree : {&a, &b}) {
        writer.put(tree->surface.topology.low);
        writer.put(tree->surface.topology.high);
    }
    put(writer);
    writer.put(std::uint64_t{XXH3_64bits(bytes.data(), bytes.size())});
    return bytes;
}

/// @param get (ByteReader&): the state itself, to the end
/// @throws Error badFile, topologyChanged
template <class Get>
void openState(std::uint64_t magic, std::span<const std::byte> bytes, const BallTree& a, const BallTree& b,
               const char* place, Get&& get) {
    constexpr std::size_t hashSize = sizeof(std::uint64_t);
    ByteReader whole(bytes, place);
    whole.require(bytes.size() > hashSize, std::to_string(bytes.size()) + " bytes are too few");
    const std::span<const std::byte> hashed = bytes.first(bytes.size() - hashSize);
    ByteReader hash(bytes.last(hashSize), place);
    ByteReader reader(hashed, place);
    reader.require(reader.get<std::uint64_t>() == magic, "no such state, or of another version");
    reader.require(hash.get<std::uint64_t>() == XXH3_64bits(hashed.data(), hashed.size()),
                   "was changed since it was saved");
    bool isOther = reader.flag() != (&a == &b);
    for (const BallTree* tree : {&a, &b}) {
        const auto low = reader.get<std::uint64_t>();
        const auto high = reader.get<std::uint64_t>();
        isOther = isOther || !(ContentKey{low, high} == tree->surface.topology);
    }
    if (isOther) {
        throw Error(Fault::topologyChanged, "saved with other meshes", place);
    }
    get(reader);
    reader.require(reader.left() == 0, "bytes left over");
}

}  // namespace grapeshot::detail
