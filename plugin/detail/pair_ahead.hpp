// What a pair knows in the phases before Bullet's pass: a copy of the bodies' poses, and what to compute from them.
#pragma once

#include <optional>

#include <grapeshot/plugin/detail/pair_processor.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

struct PairProcessor::Ahead {
    std::array<btTransform, 2> poses;
    std::array<std::optional<btCollisionObjectWrapper>, 2> bodies;  ///< over `poses`
    PairShapes shapes;
    PairTask task;
    bool ready = false;      ///< prepared in this dispatch and not yet taken
    bool attempted = false;  ///< computed at least once
    bool failed = false;     ///< out of memory on the way
};

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
