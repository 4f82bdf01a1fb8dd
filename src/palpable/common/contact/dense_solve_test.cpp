#include "palpable/common/contact/dense_solve.h"

#include <catch2/catch.hpp>

#include <cstddef>
#include <vector>

namespace palpable {
namespace {

TEST_CASE("a small system is solved for several right sides, a singular one is refused",
          "[contact]") {
  // The first pivot is 0, so that rows must be exchanged.
  std::vector<double> A{0, 2, 1, 1, 1, 0, 3, 0, 1};
  // A times the columns (1, 2, 3) and (-1, 0, 4).
  std::vector<double> B{7, 4, 3, -1, 6, 1};
  REQUIRE(solve_in_place(A.data(), 3, B.data(), 2));
  const std::vector<double> expected{1, -1, 2, 0, 3, 4};
  for (std::size_t k = 0; k < 6; ++k) CHECK(B[k] == Approx(expected[k]).margin(1e-14));

  std::vector<double> singular{1, 2, 2, 4}, b{1, 1};
  CHECK_FALSE(solve_in_place(singular.data(), 2, b.data(), 1));
}

}  // namespace
}  // namespace palpable
