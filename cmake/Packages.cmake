# The five Debian packages, for tools/package.sh, which builds them into build/packages. Each holds the
# install component of its own name: apps/CMakeLists.txt and cmake/Install.cmake say what is in these, and
# what only packages have is added here. docs/install.md is for those who install them.
option(PALPABLE_PACKAGES "Offer the target package_contents, and cpack for Debian packages" OFF)
if(NOT PALPABLE_PACKAGES)
  return()
endif()
if(NOT CMAKE_INSTALL_PREFIX STREQUAL "/usr")
  message(FATAL_ERROR "packages are installed under /usr: configure with -DCMAKE_INSTALL_PREFIX=/usr (tools/package.sh)")
endif()

set(packages palpable palpable-bake libpalpable0 libpalpable-dev python3-palpable)
# Debian's revision: it counts packages of the same sources.
set(PALPABLE_PACKAGE_VERSION ${PALPABLE_VERSION}-1)
find_program(GZIP gzip REQUIRED)

# --- what is made at package time ------------------------------------------------------------------
# A body of our own, so that `palpable live post` works at once. Its relative names keep the folder of the
# build out of the body's provenance.
set(surface ${PROJECT_SOURCE_DIR}/build/meshes/post.off)
set(body ${PROJECT_BINARY_DIR}/bodies/post.palpable)
file(RELATIVE_PATH body_in_source ${PROJECT_SOURCE_DIR} ${body})
add_custom_command(OUTPUT ${body}
  COMMAND palpable-bake bake bodies/post-small.toml -o ${body_in_source}
  DEPENDS palpable-bake ${PROJECT_SOURCE_DIR}/bodies/post-small.toml ${surface}
  WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
  COMMENT "Baking the post that ships" VERBATIM)
install(FILES ${body} DESTINATION ${CMAKE_INSTALL_DATADIR}/palpable/bodies COMPONENT palpable)

# The core for web pages and its package for npm, as `npm pack` would take them. web/build.sh makes the core.
install(FILES web/index.js web/core.js web/index.d.ts web/package.json web/README.md
        DESTINATION ${CMAKE_INSTALL_DATADIR}/palpable/npm COMPONENT palpable)
install(FILES web/dist/palpable.wasm DESTINATION ${CMAKE_INSTALL_DATADIR}/palpable/npm/dist COMPONENT palpable)

# The bundle of `palpable export --to page`, which web/page/build.sh makes.
install(FILES web/dist/page/index.html web/dist/page/page.js web/dist/page/page-classic.js web/dist/page/palpable.wasm
        DESTINATION ${CMAKE_INSTALL_DATADIR}/palpable/web COMPONENT palpable)

# The Python package, where Debian's Python looks for those of packages. It finds the library by its name.
# Elsewhere a wheel is made (docs/python.md).
install(DIRECTORY python/palpable DESTINATION lib/python3/dist-packages COMPONENT python3-palpable
        FILES_MATCHING PATTERN "*.py" PATTERN py.typed PATTERN __pycache__ EXCLUDE)

file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/bodies)
# Manual pages and completion: cmake/CommandReference.cmake.
add_custom_target(package_contents DEPENDS ${body} palpable palpable-bake palpable_library command_reference)

# --- /usr/share/doc ----------------------------------------------------------------------------------
file(STRINGS packaging/changelog first LIMIT_COUNT 1)
if(NOT first MATCHES "^palpable \\(([^)]*)\\)" OR NOT CMAKE_MATCH_1 STREQUAL PALPABLE_PACKAGE_VERSION)
  message(FATAL_ERROR "packaging/changelog begins with '${first}', but this is version ${PALPABLE_PACKAGE_VERSION}")
endif()
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS packaging/changelog)
execute_process(COMMAND ${GZIP} -9nc ${PROJECT_SOURCE_DIR}/packaging/changelog
                OUTPUT_FILE ${PROJECT_BINARY_DIR}/generated/changelog.Debian.gz COMMAND_ERROR_IS_FATAL ANY)
foreach(package IN LISTS packages)
  set(terms copyright)
  if(package STREQUAL "palpable-bake")
    set(terms copyright-palpable-bake)
  endif()
  set(doc ${CMAKE_INSTALL_DATADIR}/doc/${package})
  install(FILES packaging/${terms} DESTINATION ${doc} RENAME copyright COMPONENT ${package})
  install(FILES ${PROJECT_BINARY_DIR}/generated/changelog.Debian.gz DESTINATION ${doc} COMPONENT ${package})
endforeach()

# --- control files -----------------------------------------------------------------------------------
# CPack would write scripts that call ldconfig; Debian's policy wants a trigger. CPack leaves them out where it
# does not look at the library itself, so libpalpable0's dependencies are found by cmake/LibraryDepends.cmake.
set(control ${PROJECT_BINARY_DIR}/generated/control)
file(WRITE ${control}/triggers "activate-noawait ldconfig\n")
file(WRITE ${control}/shlibs "libpalpable ${PROJECT_VERSION_MAJOR} libpalpable0 (>= ${PALPABLE_VERSION})\n")
set(CPACK_DEBIAN_LIBPALPABLE0_PACKAGE_CONTROL_EXTRA ${control}/triggers ${control}/shlibs)
set(CPACK_DEBIAN_LIBPALPABLE0_PACKAGE_SHLIBDEPS OFF)
# Python's modules are compiled at installation, and what was compiled is removed with them.
set(CPACK_DEBIAN_PYTHON3-PALPABLE_PACKAGE_CONTROL_EXTRA
    ${PROJECT_SOURCE_DIR}/packaging/python3-palpable/postinst ${PROJECT_SOURCE_DIR}/packaging/python3-palpable/prerm)
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/cmake/LibraryDepends.cmake)

set(CPACK_GENERATOR DEB)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_COMPONENTS_ALL ${packages})
foreach(package IN LISTS packages)
  string(TOUPPER ${package} upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${package})
endforeach()
set(CPACK_PACKAGE_NAME palpable)
set(CPACK_PACKAGE_VERSION ${PALPABLE_VERSION})
set(CPACK_DEBIAN_PACKAGE_VERSION ${PALPABLE_VERSION})
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_SOURCE palpable)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
# The project has no address of its own; .invalid says so (RFC 2606).
set(CPACK_DEBIAN_PACKAGE_MAINTAINER "The Palpable developers <palpable@localhost.invalid>")
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
    OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
if(CMAKE_CROSSCOMPILING)
  set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE ${CMAKE_LIBRARY_ARCHITECTURE})
endif()

# Beside what dpkg-shlibdeps finds: Mesa's drivers draw where there is no GPU; they are loaded at run time.
set(CPACK_DEBIAN_PALPABLE_PACKAGE_DEPENDS "libegl1, libgl1, libgl1-mesa-dri")
set(CPACK_DEBIAN_PALPABLE_PACKAGE_SUGGESTS "palpable-bake (= ${PALPABLE_PACKAGE_VERSION})")
set(CPACK_DEBIAN_PALPABLE_PACKAGE_SECTION science)
# Of Debian's builds of OpenBLAS the one with pthreads: docs/install.md says why.
set(CPACK_DEBIAN_PALPABLE-BAKE_PACKAGE_DEPENDS "palpable (= ${PALPABLE_PACKAGE_VERSION}), libopenblas0-pthread")
set(CPACK_DEBIAN_PALPABLE-BAKE_PACKAGE_SUGGESTS "calculix-ccx, gnuplot-nox | gnuplot, openmpi-bin")
set(CPACK_DEBIAN_PALPABLE-BAKE_PACKAGE_SECTION science)
set(CPACK_DEBIAN_LIBPALPABLE0_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_LIBPALPABLE-DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_LIBPALPABLE-DEV_PACKAGE_DEPENDS "libpalpable0 (= ${PALPABLE_PACKAGE_VERSION})")
set(CPACK_DEBIAN_PYTHON3-PALPABLE_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON3-PALPABLE_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_PYTHON3-PALPABLE_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_PYTHON3-PALPABLE_PACKAGE_DEPENDS "python3 (>= 3.11), python3-numpy, libpalpable0 (>= ${PALPABLE_VERSION})")
set(CPACK_DEBIAN_PYTHON3-PALPABLE_PACKAGE_SUGGESTS "palpable-bake, python3-h5py, python3-matplotlib")

# The first line is the synopsis. CPack would put the summary of the whole project before each, unless that
# is its own default.
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${CMAKE_PROJECT_NAME} built using CMake")
set(CPACK_DEBIAN_PALPABLE_DESCRIPTION "virtual deformable bodies that real hands press
Palpable watches a desk through a stereo camera and lets what it sees there,
hands and things, press a virtual body of rubber. The body gives way as the
real material would, and its stress is painted on it. No GPU is needed, and no
vendor's SDK: cameras are UVC devices, recordings or a synthetic desk.
.
This package has the live half of the program and a small body to begin with:
palpable live post --source synthetic --out out
.
The package palpable-bake makes bodies from meshes.")
set(CPACK_DEBIAN_PALPABLE-BAKE_DESCRIPTION "make bodies for palpable from meshes by finite elements
This package has the offline half of Palpable: it fills a watertight surface
with tetrahedra, presses the hyperelastic body many times by finite elements
and reduces what it did to a file, which palpable then answers in every frame.
.
It links TetGen (AGPL-3+), CGAL (GPL-3+) and CHOLMOD (GPL-2+ in part), and is
therefore distributed under the GNU Affero General Public License, version 3.
Body files that it writes are their users' own.")
set(CPACK_DEBIAN_LIBPALPABLE0_DESCRIPTION "deformable bodies pressed by what a camera sees - shared library
Palpable lets what a camera sees press virtual bodies of rubber, which give way
as the real material would.
.
This package has the library for programs in C and whatever can call C: frames
or capsules in, touches, forces and the deformed skin out. It opens no window
and no camera.")
set(CPACK_DEBIAN_LIBPALPABLE-DEV_DESCRIPTION "deformable bodies pressed by what a camera sees - development files
Palpable lets what a camera sees press virtual bodies of rubber, which give way
as the real material would.
.
This package has what a program needs to be built with libpalpable: its one
header, in C, and the files for CMake and pkg-config.")
set(CPACK_DEBIAN_PYTHON3-PALPABLE_DESCRIPTION "deformable bodies pressed by what a camera sees - Python package
Palpable lets what a camera sees press virtual bodies of rubber, which give way
as the real material would.
.
This package has the module palpable for Python: hands, capsules or images in,
touches, forces, the deformed skin and its stress out, as NumPy arrays. With
palpable-bake installed it makes bodies, too.")

include(CPack)
