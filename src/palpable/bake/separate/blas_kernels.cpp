#include "palpable/bake/separate/blas_kernels.h"

#include <cblas.h>
#include <string_view>

namespace palpable {

const char* better_blas_kernels(const char* chosen, const VectorUnits& units) {
  if (std::string_view(chosen) != "Prescott") return nullptr;
  if (units.avx512) return "SkylakeX";
  return units.avx2_and_fma ? "Haswell" : nullptr;
}

const char* better_blas_kernels() {
  VectorUnits units;
  units.avx2_and_fma = __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0;
  units.avx512 = __builtin_cpu_supports("avx512f") != 0 &&
                 __builtin_cpu_supports("avx512dq") != 0 &&
                 __builtin_cpu_supports("avx512bw") != 0 && __builtin_cpu_supports("avx512vl") != 0;
  return better_blas_kernels(openblas_get_corename(), units);
}

BlasFacts blas_facts() {
  // "OpenBLAS 0.3.21 DYNAMIC_ARCH NO_AFFINITY Haswell MAX_THREADS=64"
  const std::string config = openblas_get_config();
  const std::size_t first = config.find(' ');
  return {.name = config.substr(0, config.find(' ', first == std::string::npos ? 0 : first + 1)),
          .kernels = openblas_get_corename(),
          .thread_safe = openblas_get_parallel() != 0};
}

}  // namespace palpable
