# What has threads, once more under ThreadSanitizer, in the build of its option: module X as the library
# palpable_X_watched, and its test files with cases [threads] as the program X_threads_tests. Modules
# that are not instrumented are made of the objects that the build has anyway.
#
# Instrumented are the modules whose threads are tested, those whose data go from one thread to another
# (a frame is seen on one and answered on another), and the tests. Not watched: live_writer (its thread
# hands frames to FFmpeg's encoder), clip_writer (two threads that film, in an OpenGL driver that is not
# built for it) and ranks (MPI).
option(PALPABLE_WATCH_THREADS "Offer the tests of threads under ThreadSanitizer, targets *_threads_tests" OFF)
set(PALPABLE_MODULES_WITH_THREADS campaign depth map pipeline player session slam solid sources stereo track)

function(palpable_watch target)
  # -O1: half the compiling, and these tests take seconds.
  target_compile_options(${target} PRIVATE -O1 -g1 -UNDEBUG -fsanitize=thread)
  # GCC's manual: the sanitizers hide from the compiler what it would need to see that a variable is set;
  # the plain build watches this.
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(${target} PRIVATE -Wno-maybe-uninitialized)
  endif()
endfunction()

function(palpable_watched_module name sources tests uses libraries test_libraries)
  list(TRANSFORM uses PREPEND palpable_)
  list(TRANSFORM uses APPEND _watched)
  set(watched palpable_${name}_watched)
  set(scope PUBLIC)
  if(NOT sources)
    add_library(${watched} INTERFACE)
    set(scope INTERFACE)
  elseif(name IN_LIST PALPABLE_MODULES_WITH_THREADS)
    add_library(${watched} STATIC EXCLUDE_FROM_ALL ${sources})
    palpable_watch(${watched})
    palpable_unity(${watched})
  else()
    add_library(${watched} STATIC EXCLUDE_FROM_ALL $<TARGET_OBJECTS:palpable_${name}>)
  endif()
  target_include_directories(${watched} ${scope} ${PROJECT_SOURCE_DIR}/src)
  target_link_libraries(${watched} ${scope} ${uses} ${libraries} palpable_options)

  palpable_files_with("\\[threads\\]" "${tests}" with_threads)
  if(with_threads)
    add_executable(${name}_threads_tests EXCLUDE_FROM_ALL ${with_threads})
    palpable_watch(${name}_threads_tests)
    target_link_options(${name}_threads_tests PRIVATE -fsanitize=thread)
    target_link_libraries(${name}_threads_tests PRIVATE ${watched} ${test_libraries} palpable_test_main_watched)
    palpable_discover(${name} ${name}_threads_tests threads "[threads]~[long]" 600)
  endif()
endfunction()
