// Scenes after those of Bullet's own demos of soft bodies, by their names there.
#pragma once

#include <string_view>

#include "soft_demo_world.hpp"

namespace grapeshot::bench {

struct SoftDemo {
    std::string_view name;
    bool deformable = false;
    void (*build)(SoftDemoWorld&) = nullptr;
};

/// What differs from there: Debian's Bullet has neither the demos nor their meshes, so that a torus and a lumpy ball
/// stand for its torus and rabbit, a block of tetrahedra for those of files; random numbers are others; no motors.
[[nodiscard]] std::vector<SoftDemo> softDemos();

}  // namespace grapeshot::bench
