// Small scenes in which one body comes to rest on, in or around a fixed non-convex one.
#pragma once

#include <array>
#include <string_view>

#include <scenes/world.hpp>

namespace grapeshot::test {

enum class RestScene {
    uOnBar,           ///< an upside-down U, dropped askew over a bar
    crossInHole,      ///< a plus-shaped plug, dropped askew into a plus-shaped hole with a floor
    interlockedTori,  ///< a ring hanging in a ring
    combInRails,      ///< a comb, dropped askew so that its teeth go between rails
    nutOnBolt,        ///< a nut on a thread, let go with play all around
    torusOnTorus,     ///< a torus lying in the hollow of a bigger one
    ballInCup,        ///< a bumpy ball dropped into a cup, off its middle
};
inline constexpr std::array allRestScenes{RestScene::uOnBar,      RestScene::crossInHole, RestScene::interlockedTori,
                                          RestScene::combInRails, RestScene::nutOnBolt,   RestScene::torusOnTorus,
                                          RestScene::ballInCup};

[[nodiscard]] std::string_view name(RestScene scene) noexcept;

/// Adds both bodies to an empty world and returns the index of the moving one. About 1 m in size, 1 kg.
std::size_t addRestScene(scenes::World& world, RestScene scene);

/// Settings under which rest must come from the contacts alone: no sleeping, no damping.
[[nodiscard]] scenes::WorldSettings undamped(scenes::Engine engine, double margin);

}  // namespace grapeshot::test
