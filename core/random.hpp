// Random numbers that are a pure function of what they are for.
//
// This work is based on:
// John Salmon et al. Parallel Random Numbers: As Easy as 1, 2, 3. SC 2011 (Philox4x32-10, by way of Random123)
#pragma once

#include <cstdint>

namespace grapeshot {

/// What a draw is for. Same key, same number: on every machine, in any order, on any thread. `pair` is made of the two
/// broadphase ids in ascending order (see `pairKey`), `step` counts the world's dispatches (queries are step 0).
struct RandomKey {
    std::uint64_t seed = 1;
    std::uint64_t pair = 0;
    std::uint64_t step = 0;
};

[[nodiscard]] constexpr std::uint64_t pairKey(std::uint32_t idA, std::uint32_t idB) noexcept {
    return idA < idB ? (std::uint64_t{idA} << 32U) | idB : (std::uint64_t{idB} << 32U) | idA;
}

/// 64 uniform bits.
[[nodiscard]] std::uint64_t randomBits(const RandomKey& key, std::uint32_t draw) noexcept;

/// Uniform in [0, 1), a multiple of 2^-24.
[[nodiscard]] float randomUnit(const RandomKey& key, std::uint32_t draw) noexcept;

}  // namespace grapeshot
