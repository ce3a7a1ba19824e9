# Each public header compiles alone: one source per header that includes nothing else.
#
# grapeshot_check_headers(name target ROOMS core adb) compiles them with what `target` gives its users.
function(grapeshot_check_headers name target)
    cmake_parse_arguments(arg "" "" "ROOMS" ${ARGN})
    set(sources)
    foreach(room ${arg_ROOMS})
        file(GLOB headers CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/${room}/*.hpp)
        foreach(header ${headers})
            string(MAKE_C_IDENTIFIER ${header} id)
            set(source ${PROJECT_BINARY_DIR}/header_check/${name}/${id}.cpp)
            file(CONFIGURE OUTPUT ${source} CONTENT "#include <grapeshot/${header}>\n")
            list(APPEND sources ${source})
        endforeach()
    endforeach()
    add_library(${name} OBJECT ${sources})
    target_link_libraries(${name} PRIVATE ${target} grapeshot_flags)
    target_compile_options(${name} PRIVATE -O0 -g0)  # only whether they compile
    set_target_properties(${name} PROPERTIES UNITY_BUILD OFF)
endfunction()

grapeshot_check_headers(grapeshot_header_check Grapeshot::grapeshot ROOMS core adb scf narrowphase)
grapeshot_check_headers(grapeshot_header_check_bullet Grapeshot::bullet ROOMS plugin)
# A header that compiles with one precision of Bullet does with the other: what is built in haste asks one.
if(GRAPESHOT_FLOAT64 AND NOT GRAPESHOT_UNITY)
    grapeshot_check_headers(grapeshot_header_check_bullet_float64 Grapeshot::bullet-float64 ROOMS plugin)
endif()
