// Small concave scenes by name, for files and tools.
#pragma once

#include <span>
#include <string_view>

#include <scenes/world.hpp>

namespace grapeshot::scenes {

struct NamedScene {
    std::string_view name;
    std::string_view title;  ///< what happens in it
    void (*fill)(World&);
};

[[nodiscard]] std::span<const NamedScene> namedScenes();
/// Null: there is none of that name.
[[nodiscard]] const NamedScene* findScene(std::string_view name);

}  // namespace grapeshot::scenes
