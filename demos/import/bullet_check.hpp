// Is a .bullet file what it claims to be? Bullet's own loader believes every count and pointer in it.
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace grapeshot::import {

/// Looks at chunks, structures, counts, the arrays that pointers name, the corners of triangles, and the kinds of
/// shapes, before Bullet does. No Bullet in it.
/// @throws Error badFile, indexOutOfRange: what is wrong, `place` and the byte
void checkBulletFile(std::span<const std::byte> bytes, const std::string& place);

}  // namespace grapeshot::import
