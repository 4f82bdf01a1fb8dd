#include "palpable/common/reduced/reduced_body.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/reduced/loaded_body.h"
#include "tests/support/allocations.h"
#include "tests/support/bodies.h"
#include "tests/support/dented_sphere.h"
#include "tests/support/test.h"

#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace palpable {
namespace {

using test::tolerance;

TEST_CASE("the level of a depth is exact at the samples", "[reduced]") {
  ReducedBody body = test::pressed_ball();
  const auto last = body.levels().size() - 1;
  body.press_depth.col(2) << 0, 1e-3, 3e-3, 4e-3, 9e-3;  // not linear
  tabulate_press(body);
  for (Eigen::Index k = 0; k <= last; ++k) {
    CHECK(level_of_press_depth(body, 2, body.press_depth(k, 2)) == body.levels()[k]);
    CHECK(press_depth_of_level(body, 2, body.levels()[k]) == body.press_depth(k, 2));
  }
}

TEST_CASE("depth and level are each other's inverse as far as cubics can be", "[reduced]") {
  // A body that softens by a factor of 2.6 from the first to the last level, as much as the softest
  // site of the bunny.
  const auto depth = [](double level) { return 0.01 * (level + 0.8 * level * level); };
  ReducedBody body = test::pressed_ball(0.05, 0.01, 1, 27);
  body.press_depth.col(1) = body.levels().unaryExpr(depth);
  tabulate_press(body);
  double worst = 0;
  for (double level = 0; level <= 1; level += 1e-3) {
    worst = std::max(worst, std::abs(level_of_press_depth(body, 1, depth(level)) - level));
    CHECK(press_depth_of_level(body, 1, level) ==
          Approx(depth(level)).epsilon(tolerance(1e-12, "a cubic through a parabola")));
  }
  INFO("worst level " << worst);
  CHECK(worst <= tolerance(2e-5, "26 levels; the inverse of a parabola is no cubic"));
}

TEST_CASE("the level grows with the depth and stays between 0 and 1", "[reduced][law]") {
  for (unsigned seed = 0; seed < 50; ++seed) {
    INFO("seed " << seed);
    ReducedBody body = test::pressed_ball(0.05, 0.01, 1, 9);
    auto random = test::random_case(seed);
    for (Eigen::Index k = 1; k < 9; ++k) {  // steps that differ by up to a hundred
      body.press_depth(k, 0) =
          body.press_depth(k - 1, 0) +
          1e-3 * std::pow(10, -2 * std::uniform_real_distribution<double>(0, 1)(random));
    }
    tabulate_press(body);
    const double deepest = body.press_depth(8, 0);
    double before = 0, depth_before = 0;
    bool grows = true;
    for (int i = 1; i <= 2000; ++i) {
      const double level = level_of_press_depth(body, 0, deepest * i / 2000);
      const double depth = press_depth_of_level(body, 0, i / 2000.0);
      grows &= level > before && level <= 1 && depth > depth_before;
      before = level;
      depth_before = depth;
    }
    CHECK(grows);
    CHECK(level_of_press_depth(body, 0, -2e-3) == 0);
    CHECK(level_of_press_depth(body, 0, 2 * deepest) == 1);
    CHECK(press_depth_of_level(body, 0, 1.5) == deepest);
    CHECK(press_depth_of_level(body, 0, -1) == 0);
    CHECK(level_of_press_depth(body, 0, std::nan("")) == 0);  // nothing was measured
  }
}

TEST_CASE("the tables are read without allocating, and not before they are made", "[reduced]") {
  ReducedBody body = test::pressed_ball();
  CHECK(test::allocations_during([&] {
          (void)level_of_press_depth(body, 0, 2e-3);
          (void)press_depth_of_level(body, 0, 0.3);
        }) == 0);
  CHECK_THROWS_AS(level_of_press_depth(body, 6, 0.0), ContractViolation);
  body.level_slope.resize(0, 0);
  CHECK_THROWS_AS(level_of_press_depth(body, 0, 1e-3), ContractViolation);
}

TEST_CASE("a body with a third and a fourth parameter is settled on values of them", "[reduced]") {
  const ReducedBody plain = test::pressed_ball();
  const ReducedBody body = test::with_further(plain);
  CHECK_FALSE(body.is_settled());
  const auto field = [](const SeparatedField& f, std::vector<double> mu) {
    Eigen::VectorXf u(f.value_count());
    f.evaluate(mu, std::span<float>(u.data(), static_cast<std::size_t>(u.size())));
    return u;
  };
  for (const auto& [soft, heat] : {std::pair{0.5, 0.0}, {2.0, 1.0}, {1.3, 0.25}}) {
    const ReducedBody one = settled(body, {{"softness", soft}, {"heat", heat}}).value();
    CHECK(one.is_settled());
    CHECK(one.further[0].value == soft);
    // In with_further() displacements grow by softness * (1 + heat), and forces shrink.
    const double factor = soft * (1 + heat);
    CHECK((field(one.displacement, {3, 0.6}) -
           static_cast<float>(factor) * field(plain.displacement, {3, 0.6}))
              .norm() <=
          tolerance(1e-6, "single precision") * field(one.displacement, {3, 0.6}).norm());
    CHECK(one.press_depth(2, 4) == Approx(factor * plain.press_depth(2, 4)));
    CHECK(one.sites[2].full_load == Approx((3 - soft) * plain.sites[2].full_load));
    CHECK(level_of_press_depth(one, 1, one.press_depth(1, 1)) == one.levels()[1]);
  }
  CHECK(settled(body).value().further[0].value == 1);  // the default
}

TEST_CASE("a value that the body does not have is refused by name", "[reduced][errors]") {
  const ReducedBody body = test::with_further(test::pressed_ball(0.05, 0.01, 1));
  const auto message = [](const ReducedBody& b, const std::map<std::string, double>& values) {
    const Result<ReducedBody> result = settled(b, values);
    return result.ok() ? "(settled)" : result.problem().message;
  };
  CHECK_THAT(message(body, {{"age", 3}}),
             Catch::Contains("'age' is no parameter") && Catch::Contains("'softness' 'heat'"));
  CHECK_THAT(message(body, {{"softness", 3}}), Catch::Contains("from 0.5 to 2"));
  CHECK_THAT(message(body, {{"softness", NAN}}), Catch::Contains("from 0.5 to 2"));
  CHECK_THAT(message(test::pressed_ball(0.05, 0.01, 1), {{"age", 3}}),
             Catch::Contains("it has none"));
}

TEST_CASE("von Mises stress of one pull, of pure shear and of pressure", "[reduced]") {
  const std::array<float, 18> stress{7, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 5, 5, 5, 0, 0, 0};
  std::array<float, 3> result{};
  CHECK(test::allocations_during([&] { von_mises(stress, result); }) == 0);
  CHECK(result[0] == 7.0f);
  CHECK(result[1] == Approx(2.0 * std::sqrt(3.0)).epsilon(tolerance(1e-7, "single precision")));
  CHECK(result[2] == 0.0f);
}

TEST_CASE("a body of three times the size is pressed three times as deep by nine times the force",
          "[reduced]") {
  const ReducedBody small = test::DentedSphere{}.body();
  const ReducedBody large = scaled(small, 3);
  CHECK(large.surface.vertices == 3 * small.surface.vertices);
  CHECK(large.press_depth == 3 * small.press_depth);
  CHECK(large.sites[1].full_load == Approx(9 * small.sites[1].full_load));
  CHECK(large.sites[1].direction == small.sites[1].direction);
  const std::array mu{1.0, 0.7};
  const auto size = static_cast<std::size_t>(small.displacement.value_count());
  std::vector<float> u(size), three_u(size);
  small.displacement.evaluate(mu, u);
  large.displacement.evaluate(mu, three_u);
  for (std::size_t i = 0; i < size; ++i) CHECK(three_u[i] == Approx(3 * u[i]).margin(1e-12));
  CHECK(large.stress.modes() == small.stress.modes());
  CHECK(level_of_press_depth(large, 1, 0.03) == Approx(level_of_press_depth(small, 1, 0.01)));
}

TEST_CASE("under several loads, too", "[reduced][several]") {
  const ReducedBody small = test::with_several(test::pressed_ball(0.05, 0.01, 1));
  const ReducedBody large = scaled(small, 3);
  LoadedBody of_small = LoadedBody::make(small).value(), of_large = LoadedBody::make(large).value();
  CHECK(large.several->reactions[0].full_load == Approx(9 * small.several->reactions[0].full_load));
  const std::array<PlacedLoad, 2> loads{PlacedLoad{4, 0.6}, PlacedLoad{6, 0.4}};
  REQUIRE(of_small.solve(loads).ok());
  REQUIRE(of_large.solve(loads).ok());
  CHECK(of_small.press_depth(4) > 0);
  CHECK(of_large.press_depth(4) ==
        Approx(3 * of_small.press_depth(4)).epsilon(test::tolerance(1e-5, "where Newton ends")));
}

TEST_CASE("a body of no size is refused", "[reduced][errors]") {
  const ReducedBody body = test::DentedSphere{}.body();
  CHECK_THROWS_AS(scaled(body, 0), ContractViolation);
  CHECK_THROWS_AS(scaled(body, std::numeric_limits<double>::infinity()), ContractViolation);
}

}  // namespace

}  // namespace palpable
