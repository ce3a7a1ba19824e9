// By what the contacts of two meshes are looked for.
#pragma once

#include <cstdint>
#include <string_view>

namespace grapeshot {

/// Contacts, regions and contact sets mean the same under each; they differ in how the places are found where two
/// surfaces are near, and in what is left out if a budget ends before.
enum class Method : std::uint8_t {
    automatic,  ///< the best for the pair, as measured: of rigid meshes adb
    adb,        ///< average-distribution trees; kept leaf pairs are the features that are followed from step to step
    scf,  ///< stochastic closest features on ball trees: what is near is sampled where it cannot all be looked at,
          ///< and tracked; needs a second tree. Depths, bodies in bodies and what is ahead of fast ones ask adb's
};

[[nodiscard]] constexpr std::string_view name(Method method) noexcept {
    switch (method) {
        case Method::automatic:
            return "automatic";
        case Method::adb:
            return "adb";
        case Method::scf:
            return "scf";
    }
    return "unknown";
}

}  // namespace grapeshot
