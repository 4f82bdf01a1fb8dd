#include "palpable/common/reduced/press_response.h"

#include "palpable/common/base/error.h"
#include "tests/support/bodies.h"
#include "tests/support/test.h"

#include <array>
#include <cmath>

namespace palpable {
namespace {

constexpr int kBall = 6;  // number of the ball's sites, and so the number of its reaction

TEST_CASE("one press is answered with its depth, its displacement and its stress",
          "[reduced][press_response]") {
  const ReducedBody body = test::pressed_ball(0.05, 0.01);
  const std::array<PlacedLoad, 1> press{PlacedLoad{4, 0.5}};
  const PressResponse answer = find_press_response(body, press);
  REQUIRE(answer.depth.size() == 1);
  // The baked press depth; level 0.5 is the third of five levels.
  CHECK(answer.depth[0] == Approx(body.press_depth(2, 4)).epsilon(1e-6));
  REQUIRE(answer.largest_von_mises.has_value());
  CHECK(*answer.largest_von_mises == Approx(500 * std::sqrt(3.0)).epsilon(1e-3));
  CHECK(answer.displacement.size() == 3 * static_cast<std::size_t>(body.surface.vertex_count()));
  CHECK(answer.error == body.error.displacement_worst);
}

TEST_CASE("several loads are answered together, without a stress, and refused by a body for one",
          "[reduced][press_response]") {
  const ReducedBody single = test::pressed_ball(0.05, 0.01, 1);
  const std::array<PlacedLoad, 2> loads{PlacedLoad{4, 0.6}, PlacedLoad{kBall, 0.8}};
  CHECK_THROWS_AS(find_press_response(single, loads), Error);
  const ReducedBody body = test::with_several(single);
  const PressResponse answer = find_press_response(body, loads);
  REQUIRE(answer.depth.size() == 2);
  CHECK(answer.depth[0] > 0);
  CHECK_FALSE(answer.largest_von_mises.has_value());
  CHECK(answer.error == body.several->error_worst);
  // A single load at a reaction is not a press at a site.
  const std::array<PlacedLoad, 1> reaction{PlacedLoad{kBall, 0.8}};
  CHECK_FALSE(find_press_response(body, reaction).largest_von_mises.has_value());
  // Loads beyond the body's range.
  const std::array<PlacedLoad, 2> too_much{PlacedLoad{4, 0.8}, PlacedLoad{0, 0.8}};
  CHECK_THROWS_AS(find_press_response(body, too_much), Error);
}

}  // namespace
}  // namespace palpable
