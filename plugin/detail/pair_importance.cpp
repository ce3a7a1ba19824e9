#include <grapeshot/plugin/detail/pair_importance.hpp>

#include <algorithm>
#include <cmath>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

namespace {

/// Within lower..upper; what is no number is `lower`.
float held(float value, float lower, float upper) {
    return value > lower ? std::min(value, upper) : lower;
}

float relative(float value, double mean) {
    return held(static_cast<float>(static_cast<double>(value) / mean), 0.25F, 4.0F);
}

template <class Part>
double meanOf(std::span<const PairTraits> pairs, Part&& part) {
    double sum = 0;
    int count = 0;
    for (const PairTraits& pair : pairs) {
        const float value = part(pair);
        if (value > 0 && std::isfinite(value)) {
            sum += static_cast<double>(value);
            ++count;
        }
    }
    return count > 0 ? sum / count : 1.0;
}

}  // namespace

void importanceOf(std::span<const PairTraits> pairs, std::span<float> importance) {
    constexpr float mostMotion = 8;
    constexpr float mostStale = 60;
    constexpr float leastWeight = 1e-6F;
    constexpr float mostWeight = 1e6F;
    const double mass = meanOf(pairs, [](const PairTraits& pair) { return pair.mass; });
    const double size = meanOf(pairs, [](const PairTraits& pair) { return pair.size; });
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const PairTraits& pair = pairs[i];
        const float weight =
            pair.weight > 0 && std::isfinite(pair.weight) ? std::clamp(pair.weight, leastWeight, mostWeight) : 1.0F;
        const float stale = held(static_cast<float>(pair.staleness), 0, mostStale);
        importance[i] = weight * (1 + held(pair.motion, 0, mostMotion)) * relative(pair.mass, mass) *
                        relative(pair.size, size) * (1 + 2 * stale / mostStale) * (pair.uncertain ? 2.0F : 1.0F);
    }
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
