#include "palpable/bake/separate/blas_kernels.h"

#include "tests/support/test.h"

#include <string>

namespace palpable {
namespace {

TEST_CASE("other kernels are asked for only where OpenBLAS took its oldest", "[separate][blas]") {
  CHECK(better_blas_kernels("Zen", {true, true}) == nullptr);
  CHECK(better_blas_kernels("Haswell", {true, true}) == nullptr);
  CHECK(better_blas_kernels("Prescott", {false, false}) == nullptr);
  CHECK(better_blas_kernels("Prescott", {true, false}) == std::string("Haswell"));
  CHECK(better_blas_kernels("Prescott", {true, true}) == std::string("SkylakeX"));
}

}  // namespace
}  // namespace palpable
