#include "apps/palpable-bake/blas_kernels.h"

#include <cblas.h>
#include <cstdlib>
#include <string_view>
#include <unistd.h>

namespace palpable::app {

void use_kernels_of_this_processor(char** argv) {
  if (std::getenv("OPENBLAS_CORETYPE") != nullptr) return;
  if (std::string_view(openblas_get_corename()) != "Prescott") return;
  const char* kernels = nullptr;
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) kernels = "Haswell";
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl")) {
    kernels = "SkylakeX";
  }
  if (kernels == nullptr) return;
  ::setenv("OPENBLAS_CORETYPE", kernels, 1);
  ::execv("/proc/self/exe", argv);  // does not return, unless it cannot: then it is only slow
}

}  // namespace palpable::app
