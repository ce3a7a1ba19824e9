# A build from nothing spends most of its time on the headers of others and their templates, over and over. Here those of
# the standard library and Eigen are compiled once, for every target of more than a source. Nothing of ours is among
# them; what a source has forgotten to include shows in the presets `release` and `clang`.
set(headers <algorithm> <array> <cmath> <cstdint> <functional> <limits> <map> <memory> <optional> <set> <span> <string>
            <tuple> <utility> <vector> <Eigen/Core> <Eigen/Geometry>)

# All targets of a folder and of those below it.
function(grapeshot_targets folder out)
    get_property(found DIRECTORY ${folder} PROPERTY BUILDSYSTEM_TARGETS)
    get_property(below DIRECTORY ${folder} PROPERTY SUBDIRECTORIES)
    foreach(one ${below})
        grapeshot_targets(${one} more)
        list(APPEND found ${more})
    endforeach()
    set(${out} ${found} PARENT_SCOPE)
endfunction()

# Code of shared libraries is compiled by other flags than that of programs.
foreach(kind library program)
    file(CONFIGURE OUTPUT quick_build/${kind}.cpp CONTENT "")
    add_library(grapeshot_quick_${kind} OBJECT ${CMAKE_CURRENT_BINARY_DIR}/quick_build/${kind}.cpp)
    target_link_libraries(grapeshot_quick_${kind} PRIVATE Eigen3::Eigen grapeshot_flags)
    target_precompile_headers(grapeshot_quick_${kind} PRIVATE ${headers})
endforeach()
set_target_properties(grapeshot_quick_library PROPERTIES POSITION_INDEPENDENT_CODE ON)

grapeshot_targets(${PROJECT_SOURCE_DIR} targets)
foreach(target ${targets})
    get_target_property(type ${target} TYPE)
    get_target_property(sources ${target} SOURCES)
    list(LENGTH sources count)
    if(target MATCHES "header_check|quick" OR count LESS 2)
        continue()
    elseif(type STREQUAL "SHARED_LIBRARY")
        target_precompile_headers(${target} REUSE_FROM grapeshot_quick_library)
    elseif(type MATCHES "STATIC_LIBRARY|EXECUTABLE")
        target_precompile_headers(${target} REUSE_FROM grapeshot_quick_program)
    endif()
endforeach()
