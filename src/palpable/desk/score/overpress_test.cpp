#include "palpable/desk/score/overpress.h"

#include "palpable/common/base/contract.h"
#include "tests/support/test.h"

#include <algorithm>
#include <array>

namespace palpable {
namespace {

using Eigen::Vector3d;

// Vertices at 0, 5 and 30 mm of X. The true skin sinks by 4, 2 and 0 mm.
struct Dent {
  Eigen::Matrix3Xd rest = Eigen::Matrix3Xd::Zero(3, 3);
  Eigen::Matrix3Xd truth = Eigen::Matrix3Xd::Zero(3, 3);
  Dent() {
    rest.row(0) << 0, 0.005, 0.030;
    truth.row(2) << -0.004, -0.002, 0;
  }
  [[nodiscard]] double of(const Eigen::Matrix3Xd& found) const { return at(found, {0.001, 0, 0}); }
  [[nodiscard]] double at(const Eigen::Matrix3Xd& found, const Vector3d& touched) const {
    return overpress(rest, truth, found, std::array{touched});
  }
};

TEST_CASE("a body pressed farther than the truth is overpressed by the difference", "[score]") {
  const Dent dent;
  CHECK(dent.of(dent.truth) == 0);
  CHECK(dent.of(2 * dent.truth) == Approx(0.004));
  Eigen::Matrix3Xd broad = dent.truth;
  broad(2, 1) = -0.009;  // correct at the touch, 7 mm too deep beside it
  CHECK(dent.of(broad) == Approx(0.007));
  CHECK(dent.of(0 * dent.truth) == 0);  // too small a displacement is no overpress
}

TEST_CASE("motion elsewhere, or across the true direction, is no overpress", "[score]") {
  const Dent dent;
  Eigen::Matrix3Xd found = dent.truth;
  found(2, 2) = -0.02;  // 30 mm away
  found(0, 0) = 0.003;  // across the true direction
  CHECK(dent.of(found) == Approx(0).margin(1e-15));
}

TEST_CASE("a touch between coarse vertices is at the nearest of them", "[score]") {
  const Dent dent;
  CHECK(dent.at(2 * dent.truth, {-0.05, 0, 0}) == Approx(0.004));
}

TEST_CASE("where the true skin does not move, every direction counts", "[score]") {
  Dent dent;
  dent.truth.setZero();
  Eigen::Matrix3Xd found = Eigen::Matrix3Xd::Zero(3, 3);
  found(1, 0) = 0.003;
  CHECK(dent.at(found, {0, 0, 0}) == Approx(0.003));
}

TEST_CASE("each touched place has its own direction, and the worst place counts", "[score]") {
  // Finger and thumb push the ends of a bar towards each other by 4 and 3 mm.
  Eigen::Matrix3Xd rest = Eigen::Matrix3Xd::Zero(3, 2);
  rest(0, 1) = 0.05;
  Eigen::Matrix3Xd truth = Eigen::Matrix3Xd::Zero(3, 2);
  truth.row(0) << 0.004, -0.003;
  Eigen::Matrix3Xd found = truth;
  found(0, 1) = -0.008;
  const std::array places{Vector3d(0, 0, 0), Vector3d(0.05, 0, 0)};
  CHECK(overpress(rest, truth, found, std::span(places).first(1)) == 0);
  CHECK(overpress(rest, truth, found, places) == Approx(0.005));
  for (const double first : {0.005, 0.010}) {  // 1 and 6 mm too far
    found.row(0) << first, -0.008;
    CHECK(overpress(rest, truth, found, places) == Approx(std::max(first - 0.004, 0.005)));
  }
  CHECK(overpress(rest, truth, truth, places) == 0);
}

TEST_CASE("displacements of another skin, and an empty list of touched places, are refused",
          "[score][errors]") {
  const Dent dent;
  CHECK_THROWS_AS(dent.of(dent.truth.leftCols(2)), ContractViolation);
  CHECK_THROWS_AS(overpress(dent.rest, dent.truth, dent.truth, {}), ContractViolation);
}

}  // namespace
}  // namespace palpable
