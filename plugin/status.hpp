// How a call ended: nothing is thrown into a Bullet program.
#pragma once

#include <string_view>

#include <grapeshot/plugin/precision.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {

enum class Status {
    ok,
    nullPointer,       ///< a dispatcher or shape that is none
    badSettings,       ///< a field outside its documented range; nothing was changed
    notRegistered,     ///< the dispatcher does not know us
    unsupportedShape,  ///< no triangle mesh
    unusableMesh,      ///< empty, NaN, indices out of range, ...: see Error
    badArgument,       ///< a number outside its documented range
    outOfMemory,
    badState,       ///< bytes that are no saved state, or cut off, changed, of another version or precision
    otherWorld,     ///< a saved state of other bodies, shapes or filters
    stillBuilding,  ///< a sample stands in for a mesh whose tree is being built
};

[[nodiscard]] std::string_view name(Status status) noexcept;

}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
