/// @file
/// Counts allocations, so that tests and benches can check that code allocates nothing.
#pragma once

#include <functional>

namespace palpable {

/// How many times memory is allocated on any thread during `work`, through new, malloc or Eigen, in
/// objects of this project and in static libraries. Only programs that are linked with
/// --wrap=malloc,--wrap=_Znwm,--wrap=_Znam (CMakeLists.txt: the tests and `palpable`) can use it;
/// others do not link.
int allocations_during(const std::function<void()>& work);

}  // namespace palpable
