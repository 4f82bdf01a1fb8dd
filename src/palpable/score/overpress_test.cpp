#include "palpable/score/overpress.h"

#include "palpable/base/contract.h"
#include "tests/support/test.h"

namespace palpable {
namespace {

// Vertices at 0, 5 and 30 mm of X. The true skin sinks by 4, 2 and 0 mm.
struct Dent {
  Eigen::Matrix3Xd rest = Eigen::Matrix3Xd::Zero(3, 3);
  Eigen::Matrix3Xd truth = Eigen::Matrix3Xd::Zero(3, 3);
  Dent() {
    rest.row(0) << 0, 0.005, 0.030;
    truth.row(2) << -0.004, -0.002, 0;
  }
  [[nodiscard]] double of(const Eigen::Matrix3Xd& found) const {
    return overpress(rest, truth, found, {0.001, 0, 0});
  }
};

TEST_CASE("a body pressed farther than the truth is overpressed by the difference", "[score]") {
  const Dent dent;
  CHECK(dent.of(dent.truth) == 0);
  CHECK(dent.of(2 * dent.truth) == Approx(0.004));
  Eigen::Matrix3Xd broad = dent.truth;
  broad(2, 1) = -0.009;  // right where it is touched, 7 mm too deep beside it
  CHECK(dent.of(broad) == Approx(0.007));
  CHECK(dent.of(0 * dent.truth) == 0);  // not far enough is no overpress
}

TEST_CASE("what moves elsewhere, or aside, is no overpress", "[score]") {
  const Dent dent;
  Eigen::Matrix3Xd found = dent.truth;
  found(2, 2) = -0.02;  // 30 mm away
  found(0, 0) = 0.003;  // across the true way
  CHECK(dent.of(found) == Approx(0).margin(1e-15));
}

TEST_CASE("a touch between coarse vertices is at the nearest of them", "[score]") {
  const Dent dent;
  CHECK(overpress(dent.rest, dent.truth, 2 * dent.truth, {-0.05, 0, 0}) == Approx(0.004));
}

TEST_CASE("where the true skin stays, every way counts", "[score]") {
  const Dent dent;
  Eigen::Matrix3Xd found = Eigen::Matrix3Xd::Zero(3, 3);
  found(1, 0) = 0.003;
  CHECK(overpress(dent.rest, 0 * dent.truth, found, {0, 0, 0}) == Approx(0.003));
}

TEST_CASE("displacements of another skin are refused", "[score][errors]") {
  const Dent dent;
  CHECK_THROWS_AS(dent.of(dent.truth.leftCols(2)), ContractViolation);
}

}  // namespace
}  // namespace palpable
