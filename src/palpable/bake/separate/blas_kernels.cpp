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

}  // namespace palpable
