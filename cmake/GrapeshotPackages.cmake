# The libraries this project stands on. Debian's names are in packages.txt.
find_package(PkgConfig REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(Threads REQUIRED)
find_package(TBB 2021 REQUIRED)
pkg_check_modules(HWY REQUIRED IMPORTED_TARGET libhwy)
pkg_check_modules(XXHASH REQUIRED IMPORTED_TARGET libxxhash)
find_path(RANDOM123_INCLUDE_DIR Random123/philox.h REQUIRED)

include(GrapeshotBullet)
grapeshot_find_bullet(BULLET bullet float)
if(GRAPESHOT_FLOAT64)
    grapeshot_find_bullet(BULLET64 bullet-float64 double)
endif()
