# Every third party in one place: what it is for and its licence. Which module may use it stands in
# docs/architecture.md, and a test compares that with every #include.
# docs/licences.md says what the binaries link in the end. Versions are Debian 12's.

# --- both halves -------------------------------------------------------------------------------
find_package(Eigen3 3.4 REQUIRED NO_MODULE)  # MPL-2: dense and sparse algebra
find_package(fmt 9 REQUIRED)                 # MIT: text
find_package(Threads REQUIRED)

find_package(PkgConfig REQUIRED)
pkg_check_modules(hdf5 REQUIRED IMPORTED_TARGET hdf5)  # BSD-like: body files, snapshots

# --- live half ---------------------------------------------------------------------------------
# Apache-2.0: images, rectification, block matching, features, video. Its video module brings
# Debian's ffmpeg, a GPL build (docs/licences.md).
find_package(OpenCV 4.6 REQUIRED COMPONENTS core imgproc imgcodecs calib3d features2d videoio)
# LGPL-2.1+ as it is published, a GPL build in Debian, and that one already in the program through
# OpenCV's video module: films that survive a crash and a full disk (docs/decisions/films.md).
pkg_check_modules(ffmpeg REQUIRED IMPORTED_TARGET libavformat libavcodec libswscale libavutil)
# Apache-2.0 or BSD: vector instructions chosen at run time, matcher, map, evaluation of modes.
pkg_check_modules(hwy REQUIRED IMPORTED_TARGET libhwy)
# The oldest set of vector instructions, which no processor since 2008 has as its best: a fifth of the kernels' compiling.
target_compile_definitions(PkgConfig::hwy INTERFACE HWY_DISABLED_TARGETS=HWY_SSSE3)
# BSD or GPL-2 (the BSD is taken): images of recordings, packed without loss; OpenCV's image files bring it anyway.
pkg_check_modules(zstd REQUIRED IMPORTED_TARGET libzstd)
pkg_check_modules(epoxy REQUIRED IMPORTED_TARGET epoxy)  # MIT: GL entry points
pkg_check_modules(egl REQUIRED IMPORTED_TARGET egl)      # MIT (libglvnd): GL without a screen
find_package(glfw3 3.3 REQUIRED)                         # zlib: windows
pkg_check_modules(imgui REQUIRED IMPORTED_TARGET imgui)  # MIT: the panel in windows, linked statically
find_package(PNG 1.6 REQUIRED)                           # libpng licence: picture files
# At build time only: stb_truetype (MIT or public domain) draws DejaVu Sans (Bitstream Vera
# licence: may be embedded) into a table of letters.
find_path(STB_INCLUDE_DIR stb/stb_truetype.h REQUIRED)
find_file(DEJAVU_FONT DejaVuSans.ttf PATHS /usr/share/fonts/truetype/dejavu REQUIRED)
find_package(nlohmann_json 3.11 REQUIRED)                # MIT: JSON of results, benches and pages
# BSL-1.0, headers alone: HTTP and WebSocket of `live --serve` (Boost.Beast on Boost.Asio), in one file. Frames, masks, pings
# and time limits of a protocol that strangers speak are better kept by many than by us.
find_package(Boost 1.74 REQUIRED)
find_package(CLI11 2.1 REQUIRED)                         # BSD: command lines
pkg_check_modules(tomlplusplus REQUIRED IMPORTED_TARGET tomlplusplus)  # MIT: body and scene texts

# --- bake half only (a test reads `readelf -d palpable` and refuses these there) ---------------
# CHOLMOD (LGPL, its supernodal part GPL-2+): the sparse factor.
find_path(CHOLMOD_INCLUDE_DIR cholmod.h PATH_SUFFIXES suitesparse REQUIRED)
find_library(CHOLMOD_LIBRARY cholmod REQUIRED)
add_library(palpable_cholmod INTERFACE)
target_include_directories(palpable_cholmod SYSTEM INTERFACE ${CHOLMOD_INCLUDE_DIR})
# gomp: Debian's CHOLMOD starts four OpenMP threads of its own unless told not to (GPL-3 with the
# runtime library exception; comes with the compiler).
target_link_libraries(palpable_cholmod INTERFACE ${CHOLMOD_LIBRARY} gomp)

# OpenBLAS (BSD), Debian's build with pthreads: the dense kernels of the sparse factor, the factors
# of snapshot tables. Its own threads are turned off where it is used; the serial build has no locks,
# and gives wrong numbers now and then when two threads of ours call it.
find_path(CBLAS_INCLUDE_DIR cblas.h REQUIRED)
find_library(OPENBLAS_LIBRARY openblas PATH_SUFFIXES openblas-pthread REQUIRED)
if(OPENBLAS_LIBRARY MATCHES "openblas-serial")
  message(FATAL_ERROR "${OPENBLAS_LIBRARY} has no locks: install libopenblas-pthread-dev (tools/setup.sh), "
                      "and configure with -U OPENBLAS_LIBRARY")
endif()
add_library(palpable_blas INTERFACE)
target_include_directories(palpable_blas SYSTEM INTERFACE ${CBLAS_INCLUDE_DIR})
target_link_libraries(palpable_blas INTERFACE ${OPENBLAS_LIBRARY})
find_package(pugixml 1.13 REQUIRED)  # MIT: .vtu files of others
find_package(ZLIB REQUIRED)          # zlib: packed ones
# uPlot 1.6 (MIT): charts in the pages of `report` and `compare`, compiled in; from npm by
# tools/setup.sh.
set(UPLOT_FILES)
foreach(file uPlot.iife.min.js uPlot.min.css LICENSE)
  set(path ${PROJECT_SOURCE_DIR}/build/web/uplot-1.6.32/${file})
  if(NOT EXISTS ${path})
    message(FATAL_ERROR "${path} is missing: run tools/setup.sh, or see docs/install.md")
  endif()
  list(APPEND UPLOT_FILES ${path})
endforeach()
# Open MPI 4.1 (BSD): campaigns on several machines; the program palpable-bake.
find_package(MPI 3.0 REQUIRED COMPONENTS C)
# CGAL 5.5 (GPL-3 for surface remeshing): isotropic remeshing before the volume.
find_package(CGAL 5.5 REQUIRED)
# TetGen 1.5 (AGPL-3): tetrahedra.
find_library(TETGEN_LIBRARY tet REQUIRED)
find_path(TETGEN_INCLUDE_DIR tetgen.h REQUIRED)
add_library(palpable_tetgen INTERFACE)
target_include_directories(palpable_tetgen SYSTEM INTERFACE ${TETGEN_INCLUDE_DIR})
target_link_libraries(palpable_tetgen INTERFACE ${TETGEN_LIBRARY})

# --- tests -------------------------------------------------------------------------------------
if(BUILD_TESTING)
  find_package(Catch2 2.13 REQUIRED)  # BSL-1.0
  find_package(X11 REQUIRED)          # MIT: the window test asks the X server what it shows; render
  include(Catch)
endif()
