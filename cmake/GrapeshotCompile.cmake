# How every target of this project is compiled, and where its headers are found.
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR}/bin)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_CXX_VISIBILITY_PRESET default)
set(CMAKE_VISIBILITY_INLINES_HIDDEN ON)

# grapeshot_warnings: language, warnings, headers. grapeshot_flags: the same and the sanitizer, if any.
add_library(grapeshot_warnings INTERFACE)
target_compile_features(grapeshot_warnings INTERFACE cxx_std_20)
# Same bytes on every instruction set: no contraction of a * b + c (separate rounding is part of the contract).
# Of several sources compiled as one, a local name of one may be that of a constant of another.
set(shadow $<$<NOT:$<BOOL:$<TARGET_PROPERTY:UNITY_BUILD>>>:-Wshadow>)
target_compile_options(grapeshot_warnings INTERFACE -ffp-contract=off -Wall -Wextra ${shadow} -Wpedantic
                                                    -Wnon-virtual-dtor -Woverloaded-virtual -Wundef)
# Nobody replaces a function of a library of ours by one of the same name, so calls within it may be inlined.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(grapeshot_warnings INTERFACE -fno-semantic-interposition)
endif()
add_library(grapeshot_flags INTERFACE)
target_link_libraries(grapeshot_flags INTERFACE grapeshot_warnings)
if(GRAPESHOT_SANITIZE)
    target_compile_options(grapeshot_flags INTERFACE -fsanitize=${GRAPESHOT_SANITIZE} -fno-omit-frame-pointer
                                                     -fno-sanitize-recover=all)
    target_link_options(grapeshot_flags INTERFACE -fsanitize=${GRAPESHOT_SANITIZE})
else()
    # A library with a name that nobody defines is a fault of its own link, not of the first program's. (The sanitizers'
    # names are defined by the program.)
    string(APPEND CMAKE_SHARED_LINKER_FLAGS " -Wl,-z,defs")
endif()

# <grapeshot/adb/tree.hpp> in the build tree and in the installed tree alike: one link per room.
set(GRAPESHOT_INCLUDE_DIR ${CMAKE_CURRENT_BINARY_DIR}/include)
file(MAKE_DIRECTORY ${GRAPESHOT_INCLUDE_DIR}/grapeshot)
foreach(room core adb scf narrowphase plugin plugin.hpp)
    set(target ${CMAKE_CURRENT_SOURCE_DIR}/${room})
    if(room STREQUAL "plugin.hpp")
        set(target ${CMAKE_CURRENT_SOURCE_DIR}/plugin/plugin.hpp)
    endif()
    file(CREATE_LINK ${target} ${GRAPESHOT_INCLUDE_DIR}/grapeshot/${room} SYMBOLIC)
endforeach()
target_include_directories(grapeshot_warnings INTERFACE $<BUILD_INTERFACE:${GRAPESHOT_INCLUDE_DIR}>)
