/// @file
/// Makes "allocates nothing" a thing that a test and a bench can check.
#pragma once

#include <functional>

namespace palpable {

/// How many times `work` took memory from the heap on any thread, through new, malloc or Eigen, in
/// objects of this project and in static libraries. Only for programs that are linked with
/// --wrap=malloc,--wrap=_Znwm,--wrap=_Znam (CMakeLists.txt: the tests and `palpable`); others do
/// not link.
int allocations_during(const std::function<void()>& work);

}  // namespace palpable
