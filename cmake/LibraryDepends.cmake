# What libpalpable0 depends on, by dpkg-shlibdeps, when cpack has installed the components and before it
# writes packages (CPACK_PRE_BUILD_SCRIPTS). cmake/Packages.cmake says why CPack does not ask itself.
set(staged ${CPACK_TEMPORARY_INSTALL_DIRECTORY}/libpalpable0)
file(GLOB_RECURSE libraries RELATIVE ${staged} ${staged}/usr/lib/*.so.*)
if(NOT libraries)
  message(FATAL_ERROR "no library lies in ${staged}")
endif()
# dpkg-shlibdeps reads debian/control of the folder that it runs in.
set(work ${CPACK_TOPLEVEL_DIRECTORY}/library_depends)
file(WRITE ${work}/debian/control "")
list(TRANSFORM libraries PREPEND ${staged}/)
execute_process(COMMAND dpkg-shlibdeps -O ${libraries} WORKING_DIRECTORY ${work}
                OUTPUT_VARIABLE found ERROR_VARIABLE problem RESULT_VARIABLE code OUTPUT_STRIP_TRAILING_WHITESPACE)
if(NOT code EQUAL 0 OR NOT found MATCHES "^shlibs:Depends=(.+)$")
  message(FATAL_ERROR "dpkg-shlibdeps of ${libraries}: ${found}\n${problem}")
endif()
set(CPACK_DEBIAN_LIBPALPABLE0_PACKAGE_DEPENDS "${CMAKE_MATCH_1}")
