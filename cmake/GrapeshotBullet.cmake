# Bullet in one precision, by pkg-config, and the proof that its headers and its library agree.
#
# Bullet's own package config exports variables with relative paths, and its double-precision twin cannot be found by
# name; pkg-config carries the define with the library. A program that mixes them links and corrupts memory, so whether
# they really agree is probed by linking a call with btScalar in its signature.
#
# grapeshot_find_bullet(BULLET bullet float) gives PkgConfig::BULLET.
function(grapeshot_find_bullet variant module scalar)
    pkg_check_modules(${variant} REQUIRED IMPORTED_TARGET ${module})
    set(probe ${CMAKE_CURRENT_BINARY_DIR}/bullet_probe_${scalar}.cpp)
    set(source "#include <btBulletCollisionCommon.h>
#include <type_traits>
static_assert(std::is_same_v<btScalar, ${scalar}>, \"the headers are set to another precision\");
int main() { btStaticPlaneShape plane(btVector3(0, 1, 0), btScalar(0)); return plane.getPlaneConstant() != btScalar(0); }
")
    file(CONFIGURE OUTPUT ${probe} CONTENT "${source}" @ONLY)
    try_compile(BULLET_${scalar}_AGREES ${CMAKE_CURRENT_BINARY_DIR}/bullet_probe_${scalar} ${probe}
                LINK_LIBRARIES PkgConfig::${variant} CXX_STANDARD 20 OUTPUT_VARIABLE output)
    if(NOT BULLET_${scalar}_AGREES)
        message(FATAL_ERROR "Bullet's headers and its library '${module}' disagree about btScalar = ${scalar} "
                            "(BT_USE_DOUBLE_PRECISION): a program would link and corrupt memory.\n${output}")
    endif()
endfunction()
