# What is installed: libraries, public headers (nothing from detail/ or reference/), the CMake package, pkg-config files.
# A component per precision of Bullet, so that a program without Bullet needs none.
include(CMakePackageConfigHelpers)
set(GRAPESHOT_CMAKE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/Grapeshot)

function(grapeshot_install target export_name export_set)
    set_target_properties(${target} PROPERTIES EXPORT_NAME ${export_name} VERSION ${PROJECT_VERSION}
                          SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR} INSTALL_RPATH "$ORIGIN"
                          LINK_DEPENDS ${PROJECT_SOURCE_DIR}/cmake/grapeshot.map)
    target_link_options(${target} PRIVATE LINKER:--version-script=${PROJECT_SOURCE_DIR}/cmake/grapeshot.map)
    # A call from one file of the library to another goes there, not by way of a table that the loader fills in.
    target_link_options(${target} PRIVATE LINKER:-Bsymbolic-functions)
    install(TARGETS ${target} EXPORT ${export_set} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
    install(EXPORT ${export_set} NAMESPACE Grapeshot:: DESTINATION ${GRAPESHOT_CMAKE_DIR})
endfunction()

function(grapeshot_install_pc name)
    configure_file(${PROJECT_SOURCE_DIR}/cmake/${name}.pc.in ${PROJECT_BINARY_DIR}/${name}.pc @ONLY)
    install(FILES ${PROJECT_BINARY_DIR}/${name}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endfunction()

# The prefix seen from a .pc file: the installed tree can be moved.
file(RELATIVE_PATH GRAPESHOT_PC_PREFIX /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
grapeshot_install(grapeshot grapeshot GrapeshotTargets)
grapeshot_install_pc(grapeshot)
grapeshot_install(grapeshot_bullet bullet GrapeshotBulletTargets)
grapeshot_install_pc(grapeshot-bullet)
if(GRAPESHOT_FLOAT64)
    grapeshot_install(grapeshot_bullet_float64 bullet-float64 GrapeshotBulletFloat64Targets)
    grapeshot_install_pc(grapeshot-bullet-float64)
endif()

foreach(room core adb scf narrowphase plugin)
    install(DIRECTORY ${room}/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/grapeshot/${room} FILES_MATCHING PATTERN "*.hpp"
            PATTERN detail EXCLUDE PATTERN reference EXCLUDE PATTERN preload EXCLUDE)
endforeach()
install(FILES plugin/plugin.hpp DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/grapeshot)

configure_package_config_file(cmake/GrapeshotConfig.cmake.in ${PROJECT_BINARY_DIR}/GrapeshotConfig.cmake
                              INSTALL_DESTINATION ${GRAPESHOT_CMAKE_DIR})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/GrapeshotConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/GrapeshotConfig.cmake ${PROJECT_BINARY_DIR}/GrapeshotConfigVersion.cmake
        DESTINATION ${GRAPESHOT_CMAKE_DIR})
