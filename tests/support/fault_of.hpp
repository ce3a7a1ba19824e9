// Which fault a call ends with.
#pragma once

#include <optional>

#include <grapeshot/core/error.hpp>

namespace grapeshot::test {

/// Nothing if it ends without an Error.
template <typename Call>
std::optional<Fault> faultOf(const Call& call) {
    try {
        call();
    } catch (const Error& error) {
        return error.fault();
    }
    return std::nullopt;
}

}  // namespace grapeshot::test
