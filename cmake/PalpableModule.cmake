# A module as one file: headers, of which half of a compilation consists, are read once for all of its files. On for
# whoever builds to use (preset release), off for whoever develops (preset dev): there, a change compiles one file.
# Names in anonymous namespaces must differ within a module (tools/check_names.py).
option(PALPABLE_UNITY "Compile each module as one file" OFF)

# By PALPABLE_UNITY, the target's files as one, those of a large module as two: solid as one file took 2.4 GB. Files with
# options of their own stay single (CMake sees to those), and those that Highway includes once for each instruction set.
function(palpable_unity target)
  if(NOT PALPABLE_UNITY)
    return()
  endif()
  get_target_property(sources ${target} SOURCES)
  list(FILTER sources INCLUDE REGEX "^/.*\\.cpp$")
  palpable_files_with("foreach_target\\.h" "${sources}" kernels)
  set_source_files_properties(${kernels} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  list(LENGTH sources count)
  set(batch 0)
  if(count GREATER 24)
    math(EXPR batch "(${count} + 1) / 2")
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${batch})
  # To GCC, what the one file includes is a header, whose types should have no members of anonymous namespaces.
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(${target} PRIVATE -Wno-subobject-linkage)
  endif()
endfunction()

# Those of `files` that hold a line like `regex`.
function(palpable_files_with regex files result)
  set(found)
  foreach(file IN LISTS files)
    file(STRINGS ${file} lines REGEX "${regex}")
    if(lines)
      list(APPEND found ${file})
    endif()
  endforeach()
  set(${result} ${found} PARENT_SCOPE)
endfunction()

# palpable_module(common/reduced USES base geometry LIBRARIES Eigen3::Eigen)
#
# One module = one folder of src/palpable = one static library palpable::<name> + one test program of its
# *_test.cpp files; its name is the last part of the folder. Sources are found by name: adding a file needs no edit here.
function(palpable_module folder)
  cmake_parse_arguments(arg "" "" "USES;LIBRARIES;TEST_LIBRARIES" ${ARGN})
  get_filename_component(arg_NAME ${folder} NAME)
  set(folder ${PROJECT_SOURCE_DIR}/src/palpable/${folder})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${folder}/*.cpp)
  set(tests ${sources})
  list(FILTER tests INCLUDE REGEX "_test\\.cpp$")
  list(FILTER sources EXCLUDE REGEX "_test\\.cpp$")
  list(TRANSFORM arg_USES PREPEND palpable:: OUTPUT_VARIABLE uses)

  if(sources)
    add_library(palpable_${arg_NAME} STATIC ${sources})
    palpable_precompile(palpable_${arg_NAME} library)
    palpable_unity(palpable_${arg_NAME})
    set(scope PUBLIC)
  else()
    add_library(palpable_${arg_NAME} INTERFACE)
    set(scope INTERFACE)
  endif()
  add_library(palpable::${arg_NAME} ALIAS palpable_${arg_NAME})
  target_include_directories(palpable_${arg_NAME} ${scope} ${PROJECT_SOURCE_DIR}/src)
  target_link_libraries(palpable_${arg_NAME} ${scope} ${uses} ${arg_LIBRARIES} palpable_options)

  if(BUILD_TESTING AND tests)
    palpable_tests(NAME ${arg_NAME} SOURCES ${tests} LIBRARIES palpable::${arg_NAME} ${arg_TEST_LIBRARIES})
  endif()
  if(BUILD_TESTING AND PALPABLE_WATCH_THREADS)
    palpable_watched_module(${arg_NAME} "${sources}" "${tests}" "${arg_USES}" "${arg_LIBRARIES}" "${arg_TEST_LIBRARIES}")
  endif()
endfunction()

# palpable_tests(NAME solid SOURCES ... LIBRARIES ...)
#
# Each TEST_CASE becomes a ctest "<name>/<sentence>" with the label unit.<name> or long.<name>. What
# ./check runs where follows from a case's tags: [long] in the release build, [threads] in programs of
# their own (cmake/WatchedThreads.cmake), everything else in dev. A case that cannot run here calls
# PALPABLE_SKIP and ctest says Skipped.
#
# PALPABLE_TESTS_TAGGED=long leaves out the files that have no such case, and programs without any: a
# build that runs a few cases need not compile the others.
function(palpable_tests)
  cmake_parse_arguments(arg "" "NAME" "SOURCES;LIBRARIES" ${ARGN})
  set(others ${arg_SOURCES})
  list(FILTER others EXCLUDE REGEX "_test\\.cpp$")
  list(FILTER arg_SOURCES INCLUDE REGEX "_test\\.cpp$")
  if(PALPABLE_TESTS_TAGGED)
    palpable_files_with("\\[${PALPABLE_TESTS_TAGGED}\\]" "${arg_SOURCES}" arg_SOURCES)
  endif()
  if(NOT arg_SOURCES)
    return()
  endif()
  add_executable(${arg_NAME}_tests ${arg_SOURCES} ${others})
  palpable_precompile(${arg_NAME}_tests tests)
  if(CMAKE_CXX_FLAGS MATCHES "-fsanitize=address")
    # A quarter of their compiling went into the ends of the lives of temporaries, which are watched in
    # what is tested.
    target_compile_options(${arg_NAME}_tests PRIVATE -fno-sanitize-address-use-after-scope)
  endif()
  target_link_libraries(${arg_NAME}_tests PRIVATE ${arg_LIBRARIES} palpable_test_main)
  # A program whose cases all run in another build need not be compiled with those that run in dev. The
  # line on which a TEST_CASE ends has its tags.
  foreach(source IN LISTS arg_SOURCES)
    file(STRINGS ${source} tags REGEX "\\]\"\\) {$")
    list(FILTER tags EXCLUDE REGEX "\\[(long|threads)\\]")
    if(tags)
      set_property(GLOBAL APPEND PROPERTY PALPABLE_UNIT_TESTS ${arg_NAME}_tests)
      break()
    endif()
  endforeach()
  palpable_discover(${arg_NAME} ${arg_NAME}_tests unit "~[long]~[threads]" 300)
  palpable_discover(${arg_NAME} ${arg_NAME}_tests long "[long]" 1200)
endfunction()

# The cases of a program that match, as ctests with a label.
function(palpable_discover name program label cases timeout)
  catch_discover_tests(${program} TEST_PREFIX "${name}/" WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
                       TEST_SPEC "${cases}" TEST_LIST ${program}_${label}
                       PROPERTIES LABELS ${label}.${name} TIMEOUT ${timeout}
                                  SKIP_RETURN_CODE 77)  # kSkippedExitCode of tests/support/test.h
endfunction()
