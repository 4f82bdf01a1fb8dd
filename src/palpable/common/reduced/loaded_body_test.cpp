#include "palpable/common/reduced/loaded_body.h"

#include "palpable/common/base/error.h"
#include "tests/support/allocations.h"
#include "tests/support/bodies.h"
#include "tests/support/test.h"

#include <array>
#include <cmath>
#include <limits>
#include <type_traits>
#include <vector>

namespace palpable {
namespace {

using Catch::Matchers::Contains;
using Eigen::Index;
using Eigen::Vector3d;
using Eigen::VectorXd;
using test::tolerance;

constexpr int kBall = 6;  // number of the ball's sites, and so the number of its reaction

TEST_CASE("the body under several loads is in equilibrium with all of them", "[reduced][several]") {
  const ReducedBody body = test::with_several(test::pressed_ball(0.05, 0.01, 1));
  LoadedBody loaded = LoadedBody::make(body).value();
  const std::array<PlacedLoad, 3> loads{PlacedLoad{4, 0.6}, PlacedLoad{0, 0.3},
                                        PlacedLoad{kBall, 0.8}};
  const LoadedBody::Answer answer = loaded.solve(loads);
  REQUIRE(answer.ok());
  CHECK(answer.steps > 1);  // not linear

  // The modal forces of the loads equal the gradient of the energy.
  const Eigen::MatrixXf& F = body.several->modes;
  VectorXd f = VectorXd::Zero(F.cols());
  for (const auto [place, level] : loads) {
    const Site& site = load_place(body, place);
    for (std::size_t k = 0; k < site.patch.size(); ++k) {
      const Vector3d force =
          level * site.full_load * static_cast<double>(site.weights[k]) * site.direction;
      f += F.middleRows<3>(3 * Index{site.patch[k]}).cast<double>().transpose() * force;
    }
  }
  QuarticEquilibrium energy(body.several->energy);
  (void)energy.evaluate(loaded.amplitudes());
  CHECK((energy.gradient() - f).norm() <= tolerance(1e-6, "where Newton ends") * f.norm());

  std::vector<float> u(F.rows());
  loaded.displacement(u);
  const VectorXd expected = F.cast<double>() * loaded.amplitudes();
  for (Index i = 0; i < expected.size(); ++i) {
    CHECK(static_cast<double>(u[i]) ==
          Approx(expected[i]).margin(tolerance(1e-7, "single precision of 10 mm")));
  }
  // The press depth of a place is the weighted mean displacement of its patch along its load.
  const Site& top = body.sites[4];
  double press = 0;
  for (std::size_t k = 0; k < top.patch.size(); ++k) {
    press += static_cast<double>(top.weights[k]) *
             top.direction.dot(expected.segment<3>(3 * Index{top.patch[k]}));
  }
  CHECK(loaded.press_depth(4) == Approx(press).epsilon(tolerance(1e-6, "single precision")));
  CHECK(press > 0);

  // The response to several loads is not the sum of the responses to each.
  VectorXd sum = VectorXd::Zero(F.cols());
  for (const PlacedLoad& one : loads) {
    (void)loaded.solve({});
    CHECK(loaded.amplitudes().isZero(0.0));
    REQUIRE(loaded.solve(std::array{one}).ok());
    sum += loaded.amplitudes();
  }
  REQUIRE(loaded.solve(loads).ok());
  CHECK((sum - loaded.amplitudes()).norm() > 0.05 * sum.norm());
}

TEST_CASE("a solve from the last state takes fewer steps, and nothing is allocated",
          "[reduced][several]") {
  const ReducedBody body = test::with_several(test::pressed_ball(0.05, 0.01, 1));
  LoadedBody loaded = LoadedBody::make(body).value();
  std::array<PlacedLoad, 2> loads{PlacedLoad{4, 0.7}, PlacedLoad{kBall, 0.5}};
  std::vector<float> u(body.several->modes.rows());
  LoadedBody::Answer far, near;
  static_assert(noexcept(loaded.solve(loads)));
  CHECK(test::allocations_during([&] {
          far = loaded.solve(loads);
          loads[0].level = 0.701;
          near = loaded.solve(loads);
          loaded.displacement(u);
        }) == 0);
  REQUIRE((far.ok() && near.ok()));
  CHECK(near.steps < far.steps);
}

TEST_CASE("loads that a body was not baked for are refused, and it stays as it was",
          "[reduced][several][errors]") {
  const ReducedBody body = test::with_several(test::pressed_ball(0.05, 0.01, 1));
  LoadedBody loaded = LoadedBody::make(body).value();
  REQUIRE(loaded.solve(std::array{PlacedLoad{2, 0.5}}).ok());
  const VectorXd before = loaded.amplitudes();
  const auto refusal = [&](const std::vector<PlacedLoad>& loads, LoadsRefused why) {
    LoadedBody::Answer answer;
    CHECK(test::allocations_during([&] { answer = loaded.solve(loads); }) == 0);
    CHECK(answer.refused == why);
    CHECK_FALSE(answer.ok());
    CHECK(loaded.amplitudes() == before);
    return refusal_text(body, answer, loads);
  };
  const double nan = std::nan(""), infinite = std::numeric_limits<double>::infinity();
  CHECK_THAT(refusal({{0, 0.5}, {7, 0.1}}, LoadsRefused::kNoSuchPlace),
             Contains("load 1") && Contains("no place 7") && Contains("6 sites and 1 reactions"));
  CHECK_THAT(refusal({{-1, 0.5}}, LoadsRefused::kNoSuchPlace), Contains("no place -1"));
  CHECK_THAT(refusal({{0, -0.1}}, LoadsRefused::kNoLevel), Contains("-0.1"));
  CHECK_THAT(refusal({{0, nan}}, LoadsRefused::kNoLevel), Contains("nan"));
  CHECK_THAT(refusal({{0, infinite}}, LoadsRefused::kBeyondRange), Contains("presses"));
  CHECK_THAT(refusal({{0, 0.7}, {kBall, 0.9}, {3, 0.4}}, LoadsRefused::kBeyondRange),
             Contains("presses together are 1.1 of a full load"));
  CHECK_THAT(refusal({{kBall, 1.2}}, LoadsRefused::kBeyondRange), Contains("reactions"));
  CHECK(loaded.solve(std::array{PlacedLoad{0, 0.3}, PlacedLoad{1, 0.7}}).ok());

  const ReducedBody alone = test::pressed_ball(0.05, 0.01, 1);
  CHECK_THAT(LoadedBody::make(alone).problem().message,
             Contains("'ball' answers one load at a time") && Contains("--intrusive"));
}

TEST_CASE("a point of the skin and a force give a load", "[reduced][several]") {
  const ReducedBody body = test::with_several(test::pressed_ball());
  const auto at = [&](int place) -> Vector3d {
    return body.surface.vertices.col(load_place(body, place).vertex);
  };
  const PlacedLoad top = load_at(body, at(4), 0.5).value();
  CHECK(top.place == 4);
  CHECK(top.level == Approx(0.25));  // of 2 N
  const PlacedLoad pushed = load_at(body, at(kBall), 1.5).value();
  CHECK(pushed.place == kBall);
  CHECK(pushed.level == Approx(0.5));  // of 3 N
  // A point beside the middle of a site's patch still belongs to that site.
  const int beside = body.sites[2].patch[1];
  CHECK(load_at(body, body.surface.vertices.col(beside), 2.0).value().place == 2);
  CHECK(load_at(body, at(4), 0.0).value().level == 0.0);
}

TEST_CASE("a point off the skin or off the loaded faces, and a force out of range are refused",
          "[reduced][several][errors]") {
  const ReducedBody body = test::with_several(test::pressed_ball());
  const Vector3d top = body.surface.vertices.col(body.sites[4].vertex);
  const auto refusal = [&](const Vector3d& X, double force) {
    const Result<PlacedLoad> load = load_at(body, X, force);
    return load.ok() ? std::string("nothing was refused") : load.problem().message;
  };
  CHECK_THAT(refusal(top + Vector3d(0, 0, 0.02), 1), Contains("20 mm off the body's surface") &&
                                                         Contains("site 4 at (") &&
                                                         Contains("20 mm away"));
  CHECK_THAT(refusal(top - Vector3d(0, 0, 0.03), 1), Contains("29.9 mm off"));
  // A point between top and side is on the skin, but in no patch.
  CHECK_THAT(refusal(Vector3d(0, 0, 0.05) + 0.05 * Vector3d(-1, 0, 1).normalized(), 1),
             Contains("baked for no load on") && Contains("nearest place for one is site"));
  CHECK_THAT(refusal(top, 2.5), Contains("2.5 N") && Contains("beyond the range") &&
                                    Contains("site 4") && Contains("up to 2 N"));
  CHECK_THAT(refusal(top, -1), Contains("-1 N"));
  CHECK_THAT(refusal(top, std::nan("")), Contains("nan N"));
  CHECK_THAT(refusal(Vector3d(0, std::nan(""), 0), 1), Contains("three numbers"));

  // Even if the patch of a press from above extends to the side of the body, that load is not used
  // for points on the side.
  ReducedBody wide = body;
  Site& over_all = wide.sites[4];
  for (int v = 0; v < body.surface.vertex_count(); ++v) {
    if (v != over_all.vertex) over_all.patch.push_back(v);
  }
  const Vector3d slope(0, 0, 0.05), north = Vector3d(-1, 0, 3).normalized(),
                                    side = Vector3d(-1, 1, 0).normalized();
  CHECK(load_at(wide, slope + 0.05 * north, 1).value().place == 4);
  wide.several.reset();
  wide.sites = {Site(over_all)};
  CHECK_FALSE(load_at(wide, slope + 0.05 * side, 1).ok());
}

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
