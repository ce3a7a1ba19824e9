// By what the contacts of two meshes are looked for.
#pragma once

#include <cstdint>
#include <string_view>

namespace grapeshot {

/// Contacts, regions and contact sets mean the same under each; they differ in how the places are found where two
/// surfaces are near, and in what a budget that ends before does to that.
enum class Method : std::uint8_t {
    automatic,  ///< adb finds and ranks the regions; from what is known the search spreads over the neighbourhood
    adb,        ///< average-distribution trees, exact triangle tests at the leaves
    scf,        ///< stochastic closest features: pairs tracked from step to step, new ones sampled; needs a second tree
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
