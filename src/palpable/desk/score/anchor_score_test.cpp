#include "palpable/desk/score/anchor_score.h"

#include "tests/support/test.h"

#include <cmath>

namespace palpable {
namespace {

using Eigen::AngleAxisd;
using Eigen::Vector3d;
using test::tolerance;

Rigid3 at(double x, double y, double z) { return Rigid3(Eigen::Translation3d(x, y, z)); }

TEST_CASE("a body drawn 3 mm to the left and to the right by turns has a jitter of 3 mm",
          "[score]") {
  AnchorScorer scorer;
  CHECK_FALSE(scorer.jitter().has_value());
  for (int n = 0; n < 10; ++n)
    scorer.add(Rigid3::Identity(), at(n % 2 == 0 ? 0.003 : -0.003, 0.1, 0.5));
  CHECK(scorer.frames() == 10);
  CHECK(*scorer.jitter() == Approx(0.003));
}

TEST_CASE("a body that moves with a camera that is assumed fixed jitters by the camera's motion",
          "[score]") {
  AnchorScorer scorer;
  // 0, 6 and 12 mm: mean 6 mm, squared deviations 36, 0 and 36 mm^2
  for (const double x : {0.0, 0.006, 0.012}) scorer.add(at(x, 0, 0), at(0, 0, 0.5));
  CHECK(*scorer.jitter() == Approx(std::sqrt(24.0) * 1e-3));
}

TEST_CASE("a body that stays where it is in the world does not jitter, however the camera moves",
          "[score][law]") {
  auto random = test::random_case(1);
  std::uniform_real_distribution<double> number(-1, 1);
  const Rigid3 world_from_body = at(0.3, -0.1, 0.6);
  AnchorScorer scorer;
  for (int n = 0; n < 50; ++n) {
    const Vector3d axis = Vector3d(number(random), number(random), number(random)).normalized();
    const Rigid3 camera = at(number(random), number(random), number(random)) *
                          Rigid3(AngleAxisd(number(random), axis));
    scorer.add(camera, camera.inverse() * world_from_body);
  }
  CHECK(*scorer.jitter() <= tolerance(1e-12, "rounding of metres"));
}

TEST_CASE("a wrong but constant position is no jitter", "[score]") {
  AnchorScorer scorer;
  for (int n = 0; n < 3; ++n) scorer.add(Rigid3::Identity(), at(5, 5, 5));
  CHECK(*scorer.jitter() == 0);
}

}  // namespace
}  // namespace palpable
