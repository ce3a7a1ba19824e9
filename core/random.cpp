#include <grapeshot/core/random.hpp>

#include <Random123/philox.h>

namespace grapeshot {

std::uint64_t randomBits(const RandomKey& key, std::uint32_t draw) noexcept {
    // One block per draw. Philox4x32 has 192 bits for key and counter, an identity 224: the upper half of the step is
    // folded into the key, so identities are distinct by construction up to 2^32 steps (two years at 60 Hz).
    const auto low = [](std::uint64_t x) { return static_cast<std::uint32_t>(x); };
    const auto high = [](std::uint64_t x) { return static_cast<std::uint32_t>(x >> 32U); };
    const r123::Philox4x32::ctr_type counter = {{low(key.pair), high(key.pair), low(key.step), draw}};
    const r123::Philox4x32::key_type cipherKey = {{low(key.seed), high(key.seed) ^ high(key.step)}};
    const r123::Philox4x32::ctr_type block = r123::Philox4x32()(counter, cipherKey);
    return std::uint64_t{block[1]} << 32U | block[0];
}

float randomUnit(const RandomKey& key, std::uint32_t draw) noexcept {
    return static_cast<float>(randomBits(key, draw) >> 40U) * 0x1p-24F;
}

}  // namespace grapeshot
