// Settings out of their range, named.
#pragma once

#include <string>

#include <grapeshot/core/error.hpp>

namespace grapeshot::detail {

/// @param place the setting, as "AuditSettings::share"
/// @throws Error badSetting with the value, unless it is fine. Compare so that a NaN is not.
inline void requireSetting(bool fine, const char* place, double value) {
    if (!fine) {
        throw Error(Fault::badSetting, std::to_string(value), place);
    }
}

}  // namespace grapeshot::detail
