# Headers that most files include, parsed once instead of 700 times: half of a compilation was their text.
#
#   palpable_precompile(palpable_bake library)
#   palpable_precompile(reduced_tests tests)        also Catch2
#
# What is written in the files stays as it was: each includes what it uses (clang-tidy reads them without
# this). A file with compile options of its own, or macros before its first include, is left out by
# SKIP_PRECOMPILE_HEADERS.
option(PALPABLE_PRECOMPILE "Parse common headers once for all files" ON)

set(headers <algorithm> <array> <cmath> <cstdint> <filesystem> <functional> <limits> <map> <memory> <optional>
            <span> <string> <string_view> <utility> <vector> <Eigen/Core> <Eigen/Geometry> <fmt/format.h>)
set(palpable_headers_library ${headers})
set(palpable_headers_tests ${headers} <random> <catch2/catch.hpp>)

if(PALPABLE_PRECOMPILE)
  # What ccache needs to know precompiled headers by their content.
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    add_compile_options(-fpch-preprocess)
  else()
    add_compile_options("SHELL:-Xclang -fno-pch-timestamp")
  endif()
  foreach(kind library tests)
    if(kind STREQUAL tests AND NOT BUILD_TESTING)
      continue()
    endif()
    set(empty ${PROJECT_BINARY_DIR}/generated/precompiled_${kind}.cpp)
    if(NOT EXISTS ${empty})
      file(WRITE ${empty} "// Only its precompiled headers are used.\n")
    endif()
    add_library(palpable_precompiled_${kind} OBJECT ${empty})
    target_link_libraries(palpable_precompiled_${kind} PRIVATE palpable_options Eigen3::Eigen fmt::fmt)
    if(kind STREQUAL tests)
      target_link_libraries(palpable_precompiled_${kind} PRIVATE Catch2::Catch2)
    endif()
    target_precompile_headers(palpable_precompiled_${kind} PRIVATE ${palpable_headers_${kind}})
  endforeach()
endif()

function(palpable_precompile target kind)
  if(PALPABLE_PRECOMPILE)
    target_precompile_headers(${target} REUSE_FROM palpable_precompiled_${kind})
  endif()
endfunction()
