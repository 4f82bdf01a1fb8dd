# The threads build instruments the modules whose threads are tested there, those whose data go from
# one thread to another (a frame is seen on one and answered on another), and the tests. All else is
# compiled with release's own options, so that ccache has it already. Not watched: live_writer (its
# thread hands frames to FFmpeg's encoder), clip_writer (two threads that film, in an OpenGL driver
# that is not built for it) and ranks (MPI).
set(PALPABLE_MODULES_WITH_THREADS bake campaign depth live map session slam solid sources stereo track)
function(palpable_sanitize_threads target)
  target_compile_options(${target} PRIVATE -O2 -g1 -UNDEBUG -fsanitize=thread)
  get_target_property(type ${target} TYPE)
  if(type STREQUAL "EXECUTABLE")
    target_link_options(${target} PRIVATE -fsanitize=thread)
  endif()
endfunction()

# palpable_module(NAME reduced USES base geometry LIBRARIES Eigen3::Eigen)
#
# One module = one folder = one static library palpable::<name> + one test program of its
# *_test.cpp files. Sources are found by name: adding a file needs no edit here.
function(palpable_module)
  cmake_parse_arguments(arg "" "NAME" "USES;LIBRARIES;TEST_LIBRARIES" ${ARGN})
  set(folder ${PROJECT_SOURCE_DIR}/src/palpable/${arg_NAME})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${folder}/*.cpp)
  set(tests ${sources})
  list(FILTER tests INCLUDE REGEX "_test\\.cpp$")
  list(FILTER sources EXCLUDE REGEX "_test\\.cpp$")
  list(TRANSFORM arg_USES PREPEND palpable::)

  if(sources)
    add_library(palpable_${arg_NAME} STATIC ${sources})
    if(PALPABLE_THREAD_SANITIZER AND arg_NAME IN_LIST PALPABLE_MODULES_WITH_THREADS)
      palpable_sanitize_threads(palpable_${arg_NAME})
    else()
      palpable_precompile(palpable_${arg_NAME} library)
    endif()
    set(scope PUBLIC)
  else()
    add_library(palpable_${arg_NAME} INTERFACE)
    set(scope INTERFACE)
  endif()
  add_library(palpable::${arg_NAME} ALIAS palpable_${arg_NAME})
  target_include_directories(palpable_${arg_NAME} ${scope} ${PROJECT_SOURCE_DIR}/src)
  target_link_libraries(palpable_${arg_NAME} ${scope} ${arg_USES} ${arg_LIBRARIES} palpable_options)

  if(BUILD_TESTING AND tests)
    palpable_tests(NAME ${arg_NAME} SOURCES ${tests} LIBRARIES palpable::${arg_NAME} ${arg_TEST_LIBRARIES})
  endif()
endfunction()

# palpable_tests(NAME solid SOURCES ... LIBRARIES ...)
#
# Each TEST_CASE becomes a ctest "<name>/<sentence>" with the label unit.<name>, long.<name> or
# threads.<name>. What ./check runs where follows from a case's tags: [long] in the release build,
# [threads] in the threads build, everything else in dev. A case that cannot run here calls PALPABLE_SKIP and ctest says Skipped.
#
# PALPABLE_TESTS_TAGGED=threads leaves out the files that have no such case, and programs without any:
# a build that runs a few cases need not compile the others.
function(palpable_tests)
  cmake_parse_arguments(arg "" "NAME" "SOURCES;LIBRARIES" ${ARGN})
  if(PALPABLE_TESTS_TAGGED)
    set(any FALSE)
    foreach(source IN LISTS arg_SOURCES)
      if(NOT source MATCHES "_test\\.cpp$")
        continue()
      endif()
      file(STRINGS ${source} cases REGEX "\\[${PALPABLE_TESTS_TAGGED}\\]")
      if(cases)
        set(any TRUE)
      else()
        list(REMOVE_ITEM arg_SOURCES ${source})
      endif()
    endforeach()
    if(NOT any)
      return()
    endif()
  endif()
  add_executable(${arg_NAME}_tests ${arg_SOURCES})
  if(PALPABLE_THREAD_SANITIZER)
    palpable_sanitize_threads(${arg_NAME}_tests)
  else()
    palpable_precompile(${arg_NAME}_tests tests)
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
  set(skip SKIP_RETURN_CODE 77)  # kSkippedExitCode of tests/support/test.h
  set(common TEST_PREFIX "${arg_NAME}/" WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
  catch_discover_tests(${arg_NAME}_tests ${common} TEST_SPEC "~[long]~[threads]"
                       TEST_LIST ${arg_NAME}_unit PROPERTIES LABELS unit.${arg_NAME} TIMEOUT 300 ${skip})
  catch_discover_tests(${arg_NAME}_tests ${common} TEST_SPEC "[long]"
                       TEST_LIST ${arg_NAME}_long PROPERTIES LABELS long.${arg_NAME} TIMEOUT 1200 ${skip})
  catch_discover_tests(${arg_NAME}_tests ${common} TEST_SPEC "[threads]~[long]"
                       TEST_LIST ${arg_NAME}_threads PROPERTIES LABELS threads.${arg_NAME} TIMEOUT 600 ${skip})
endfunction()
