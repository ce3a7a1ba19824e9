#include <grapeshot/scf/detail/side_memory.hpp>

#include <algorithm>
#include <cmath>

#include <grapeshot/scf/detail/state_bytes.hpp>

namespace grapeshot::detail {
namespace {

constexpr std::uint64_t sideMagic = 0x0131'4544'4953'5347U;  // "GSSIDE1", then the version
constexpr std::size_t bytesPerEntry = 19;

bool isBefore(const KeptSides& x, const KeptSides& y) {
    return x.key < y.key;
}

}  // namespace

const KeptSides* SideMemory::find(std::uint64_t key) const {
    const auto place = std::lower_bound(kept.begin(), kept.end(), KeptSides{key, 0, {}, false}, isBefore);
    return place != kept.end() && place->key == key ? &*place : nullptr;
}

void SideMemory::merge(std::vector<KeptSides>& asked, std::uint32_t keepSteps) {
    // Of those with the same key the first stays: stable, and new ones before old ones.
    std::stable_sort(asked.begin(), asked.end(), isBefore);
    std::vector<KeptSides> all;
    all.reserve(asked.size() + kept.size());
    std::merge(asked.begin(), asked.end(), kept.begin(), kept.end(), std::back_inserter(all), isBefore);
    const auto sameKey = [](const KeptSides& x, const KeptSides& y) { return x.key == y.key; };
    all.erase(std::unique(all.begin(), all.end(), sameKey), all.end());
    std::erase_if(all, [&](const KeptSides& one) { return step - one.step > keepSteps; });
    kept = std::move(all);
}

std::vector<std::byte> savedSides(const SideMemory& memory, const BallTree& a, const BallTree& b) {
    return sealedState(sideMagic, a, b, [&](ByteWriter& writer) {
        writer.put(memory.step);
        writer.put(memory.spacing);
        writer.put(std::uint64_t{memory.kept.size()});
        for (const KeptSides& one : memory.kept) {
            writer.put(one.key);
            writer.put(one.step);
            writer.put(one.sides.ofA);
            writer.put(one.sides.ofB);
            writer.put(static_cast<std::uint8_t>(one.isCrossed ? 1 : 0));
        }
    });
}

SideMemory loadedSides(std::span<const std::byte> bytes, const BallTree& a, const BallTree& b) {
    SideMemory memory;
    openState(sideMagic, bytes, a, b, "SideKeeper::load", [&](ByteReader& reader) {
        memory.step = reader.get<std::uint64_t>();
        memory.spacing = reader.get<float>();
        reader.require(std::isfinite(memory.spacing) && memory.spacing >= 0, "a spacing that is none");
        const std::size_t count = reader.count(bytesPerEntry);
        for (std::size_t i = 0; i < count; ++i) {
            KeptSides one;
            one.key = reader.get<std::uint64_t>();
            one.step = reader.get<std::uint64_t>();
            one.sides.ofA = reader.get<std::int8_t>();
            one.sides.ofB = reader.get<std::int8_t>();
            one.isCrossed = reader.flag();
            const auto isSide = [](int side) { return side == 1 || side == -1; };
            reader.require(isSide(one.sides.ofA) && isSide(one.sides.ofB) && one.step <= memory.step &&
                               (memory.kept.empty() || memory.kept.back().key < one.key),
                           "sides out of range or order");
            memory.kept.push_back(one);
        }
    });
    return memory;
}

}  // namespace grapeshot::detail
