#include "apps/palpable-bake/processor_kernels.h"

#include "palpable/bake/separate/dense_algebra.h"

#include <cstdlib>
#include <unistd.h>

namespace palpable::app {

void use_kernels_of_this_processor(char** argv) {
  if (std::getenv("OPENBLAS_CORETYPE") != nullptr) return;
  const char* kernels = better_blas_kernels();
  if (kernels == nullptr) return;
  ::setenv("OPENBLAS_CORETYPE", kernels, 1);
  ::execv("/proc/self/exe", argv);
}

}  // namespace palpable::app
