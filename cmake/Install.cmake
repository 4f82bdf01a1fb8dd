# What `cmake --install` puts where: libpalpable.so with its header, how CMake and pkg-config find it,
# the licence; apps/ adds the programs. docs/c_interface.md is for those who use it. Components are named
# after the Debian package that holds them (cmake/Packages.cmake); without --component all are installed.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

# The live half as far as it needs no window and no video, behind the functions of palpable.h. Its users
# link nothing else: what it links itself it links privately. A test reads what it exports and links.
add_library(palpable_library SHARED $<TARGET_OBJECTS:palpable_capi>)
target_link_libraries(palpable_library PRIVATE palpable::session palpable::body_file palpable::sources)
# Modules bring all of OpenCV; only what is called is linked. Nothing but palpable_* is exported, not even
# templates of the standard library.
target_link_options(palpable_library PRIVATE LINKER:--as-needed
                    LINKER:--version-script=${PROJECT_SOURCE_DIR}/cmake/exported_names.map)
set_target_properties(palpable_library PROPERTIES
  OUTPUT_NAME palpable EXPORT_NAME palpable LINKER_LANGUAGE CXX VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}
  LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/lib LINK_DEPENDS ${PROJECT_SOURCE_DIR}/cmake/exported_names.map)

install(TARGETS palpable_library EXPORT palpable
        LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT libpalpable0 NAMELINK_COMPONENT libpalpable-dev
        INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(FILES src/palpable/live/capi/palpable.h src/palpable/live/capi/hands.h
        DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/palpable COMPONENT libpalpable-dev)
# In no package: each of these has a file `copyright` instead.
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT licence)

set(packages ${CMAKE_INSTALL_LIBDIR}/cmake/palpable)
configure_package_config_file(cmake/palpableConfig.cmake.in generated/palpableConfig.cmake INSTALL_DESTINATION ${packages})
write_basic_package_version_file(generated/palpableConfigVersion.cmake COMPATIBILITY SameMajorVersion)
install(EXPORT palpable NAMESPACE palpable:: FILE palpableTargets.cmake DESTINATION ${packages}
        COMPONENT libpalpable-dev)
install(FILES ${PROJECT_BINARY_DIR}/generated/palpableConfig.cmake
              ${PROJECT_BINARY_DIR}/generated/palpableConfigVersion.cmake DESTINATION ${packages}
        COMPONENT libpalpable-dev)

# An installed folder may be moved: its own place is looked up from where the .pc file lies.
file(RELATIVE_PATH PREFIX_FROM_PC /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
configure_file(cmake/palpable.pc.in generated/palpable.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/generated/palpable.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig
        COMPONENT libpalpable-dev)
