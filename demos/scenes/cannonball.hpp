// The shot: non-convex cannonballs against a wall and a tower of non-convex blocks, everything moving.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <scenes/shapes.hpp>
#include <scenes/world.hpp>

namespace grapeshot::scenes {

struct CannonballSettings {
    Engine engine = Engine::grapeshot;
    Settings settings = {};   ///< for Engine::grapeshot
    bool meshGround = false;  ///< a triangle mesh instead of a plane
    double detail = 1;        ///< lengths of triangles' edges are divided by it: 2 makes about four times as many
    std::vector<Mesh> furtherBalls;  ///< any unit and place: each is centred and scaled to `furtherBallSize`
    double furtherBallSize = 0.9;    ///< diagonal of the box, m
    double perturbation = 0;         ///< relative change of each ball's velocity and spin
    std::uint64_t seed = 1;          ///< of the perturbation
};

/// SI units. The wall stands in the plane z = 0, the tower behind it; the balls fly towards +z.
struct CannonballScene {
    World world;
    std::vector<std::size_t> balls = {};   ///< bodies
    std::vector<std::size_t> blocks = {};  ///< bodies
    std::vector<std::string> ballNames = {};
    std::size_t ground = 0;
    std::size_t triangles = 0;  ///< of all moving bodies
};

[[nodiscard]] CannonballScene makeCannonball(const CannonballSettings& settings = {});

}  // namespace grapeshot::scenes
