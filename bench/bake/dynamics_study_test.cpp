#include "bench/bake/dynamics_study.h"

#include "palpable/bake/solid/contact.h"
#include "palpable/bake/solid/vibration_modes.h"
#include "palpable/bake/touch_bake/vibration_maker.h"
#include "palpable/common/base/error.h"
#include "tests/support/standing_rubber.h"
#include "tests/support/test.h"

#include <array>
#include <cmath>
#include <numbers>

namespace palpable {
namespace {

using Eigen::Matrix3Xd;
using test::tolerance;

constexpr double kPi = std::numbers::pi;

// exp(-d t) cos(omega t + phase) at 0, h, 2 h ...
Ring damped_cosine(double d, double omega, double phase, double h, int samples) {
  Ring ring{h, {}};
  for (int n = 0; n < samples; ++n) {
    ring.motion.push_back(std::exp(-d * n * h) * std::cos(omega * n * h + phase));
  }
  return ring;
}

TEST_CASE("zero crossings and swings are found between the samples", "[bench][dynamics]") {
  const Ring ring = damped_cosine(0, 10, 0.3, 0.01, 200);
  const std::vector<double> times = zero_crossings(ring), sizes = swings(ring);
  REQUIRE(times.size() == 6);  // 10 * 1.99 + 0.3 = 20.2 rad: beyond 5.5 pi and 6.4 pi
  REQUIRE(sizes.size() == 5);
  for (std::size_t k = 0; k < times.size(); ++k) {
    CHECK(std::abs(times[k] - ((static_cast<double>(k) + 0.5) * kPi - 0.3) / 10) <=
          tolerance(1e-5, "a line instead of a sine, over steps of 0.1 rad"));
    if (k == 5) break;
    CHECK(std::abs(sizes[k] - (k % 2 == 0 ? -1 : 1)) <=
          tolerance(1e-5, "a parabola instead of a cosine"));
  }
  CHECK(zero_crossings({0.1, {1, 0, -1, 0, 1}}).size() == 2);
  CHECK(zero_crossings({0.1, {0, 1, 2}}).empty());
  CHECK(zero_crossings({0.1, {}}).empty());
}

TEST_CASE("a ring that is larger, later and slower is reported to be", "[bench][dynamics]") {
  const Ring truth = damped_cosine(1, 10, 0, 0.005, 500);
  Ring larger = truth;
  for (double& u : larger.motion) u *= 1.1;
  const RingDifference of_size = ring_difference(larger, truth);
  CHECK(of_size.amplitude == Approx(0.1).epsilon(tolerance(1e-9, "rounding")));
  CHECK(of_size.amplitudes.size() == 5);
  CHECK(of_size.phase == 0);
  CHECK(of_size.trace == Approx(0.1).epsilon(tolerance(1e-9, "rounding")));
  CHECK(of_size.period == Approx(2 * kPi / 10).epsilon(tolerance(1e-4, "linear between samples")));

  // Later by 0.03 of a period.
  const RingDifference of_phase =
      ring_difference(damped_cosine(1, 10, -0.06 * kPi, 0.005, 500), truth);
  CHECK(of_phase.phase == Approx(0.03).margin(tolerance(1e-4, "linear between samples")));
  // Slower by 1 %: at the fifth crossing, after 2.25 periods, later by 0.0225.
  const RingDifference slower = ring_difference(damped_cosine(1, 10 / 1.01, 0, 0.005, 500), truth);
  CHECK(slower.phase == Approx(0.0225).margin(tolerance(1e-4, "linear between samples")));
  // exp(-2.5 pi (1.01 - 1) 0.1 ...): it has lost more by its later swings.
  CHECK(slower.amplitude < tolerance(0.03, "exp(-t) over 1 % of 1.7 s"));

  CHECK_THROWS_AS(ring_difference(truth, damped_cosine(1, 10, 0, 0.005, 300)), Error);
}

// A slender column, its modes and the place that is plucked.
struct Column {
  SolidModel model = test::standing_rubber(box_tets({0, 0, 0}, {0.012, 0.02, 0.08}, 2, 3, 10));
  SkinResponse skin{model, boundary_of(model.mesh)};
  VibrationTable table =
      make_vibration(skin, {.density = 1070, .loss_factor = 0.15, .modes = 20, .below = 0});
  PluckedPlace place = softest_place(skin, table);
};

TEST_CASE("the softest place of a column is a corner of its end, along its thin side",
          "[bench][dynamics]") {
  const Column column;
  CHECK(column.skin.skin().vertices(2, column.place.vertex) == Approx(0.08));
  CHECK(std::abs(column.place.direction[0]) > 0.9);
  CHECK(column.place.direction.norm() == Approx(1));
  CHECK(unit_pull(column.skin, column.place).colwise().norm().sum() == Approx(1));
}

TEST_CASE("modes ring as the closed form of one oscillator says", "[bench][dynamics]") {
  VibrationTable table;
  table.omega = {20};
  table.shapes = Eigen::MatrixXf::Zero(1, 6);
  table.shapes.row(0) << 9, 9, 9, 2, 0, 1;
  table.loss_factor = 0.2;
  const PluckedPlace place{1, {0, 0, 1}};
  const Ring ring = ring_of_modes(table, place, 3.0, 0.001, 1200);
  CHECK(ring.motion.front() == Approx(3.0 / 400));
  const double damped = 20 * std::sqrt(1 - 0.01);
  const std::vector<double> sizes = swings(ring), times = zero_crossings(ring);
  REQUIRE(sizes.size() >= 4);
  for (std::size_t k = 0; k < 4; ++k) {
    CHECK(sizes[k] / (3.0 / 400) ==
          Approx((k % 2 == 0 ? -1 : 1) * std::exp(-2.0 * kPi * static_cast<double>(k + 1) / damped))
              .epsilon(tolerance(1e-5, "a parabola instead of a cosine")));
    CHECK(times[k + 1] - times[k] ==
          Approx(kPi / damped).epsilon(tolerance(1e-4, "linear between samples")));
  }
}

TEST_CASE("a column that is plucked a little rings in full as in its modes", "[bench][dynamics]") {
  const Column column;
  const EquilibriumSolver solver(column.model);
  const LoadSearch pull = solver.find_load(unit_pull(column.skin, column.place), 1e-4);
  REQUIRE(pull.reached);
  const VibrationModes modes = vibration_modes(column.skin.body(), 1070, {.least = 20, .below = 0});
  const double h = 2 * kPi / modes.omega[0] / 80;
  const auto ring_with = [&](double time_step) {
    ImplicitDynamics dynamics(column.model, 1070, {modes.omega, modes.shapes, 0.075},
                              {.time_step = time_step});
    return ring_in_full(dynamics, column.skin, column.place, pull.state.displacement, time_step,
                        kComparedCrossings, 10);
  };
  const FullRing full = ring_with(h), half = ring_with(h / 2), quarter = ring_with(h / 4);
  INFO("balance errors " << full.balance_error / full.energy << " "
                         << half.balance_error / half.energy << " "
                         << quarter.balance_error / quarter.energy);
  CHECK(full.ring.motion.front() == Approx(1e-4).epsilon(tolerance(1e-5, "find_load()'s 1e-6")));
  CHECK(full.energy == Approx(0.5 * pull.load * 1e-4).epsilon(tolerance(0.01, "nearly linear")));
  CHECK(full.energy_rise / full.energy <= tolerance(1e-6, "the solves"));
  CHECK(full.balance_error / full.energy <=
        tolerance(0.02, "a point load that goes starts motion that these steps do not follow"));
  CHECK(half.balance_error < 0.5 * full.balance_error);
  CHECK(quarter.balance_error < 0.5 * half.balance_error);
  CHECK(zero_crossings(full.ring).size() == kComparedCrossings);
  const Ring predicted = ring_of_modes(column.table, column.place, pull.load, h, 2 * full.steps);
  const RingDifference difference = ring_difference(predicted, full.ring);
  INFO("phase " << difference.phase << ", trace " << difference.trace);
  CHECK(difference.amplitude <= tolerance(0.02, "what modes beyond the 20th have; the step"));
  CHECK(std::abs(difference.phase) <=
        tolerance(0.005, "0.088 (omega h)^2 of 2.25 periods is 0.0012; modes beyond"));
}

TEST_CASE("forces are averaged in groups", "[bench][dynamics]") {
  const std::vector<Eigen::Vector3d> forces{{1, 0, 0}, {3, 0, 0}, {0, 0, 8}, {0, 6, 8}, {9, 9, 9}};
  const std::vector<Eigen::Vector3d> means = means_of_groups(forces, 2);
  REQUIRE(means.size() == 2);
  CHECK(means[0] == Eigen::Vector3d(2, 0, 0));
  CHECK(means[1] == Eigen::Vector3d(0, 3, 8));
  CHECK(peak_of(forces) == Approx(9 * std::sqrt(3.0)));
  CHECK(peak_of({}) == 0);
}

TEST_CASE("a ball that comes slowly is borne as at rest, a fast one meets the mass as well",
          "[bench][dynamics]") {
  const SolidModel model =
      test::standing_rubber(box_tets({-0.03, -0.025, 0}, {0.03, 0.025, 0.04}, 6, 5, 4));
  const EquilibriumSolver solver(model);
  const SkinResponse skin(model, boundary_of(model.mesh));
  const VibrationModes modes = vibration_modes(skin.body(), 1070, {.least = 12, .below = 0});
  constexpr double kRadius = 0.012, kSpacing = 0.003;  // m
  Hit hit;
  hit.scene.touching = {.capsules = {ball({0.001, 0.002, 0.04 + kRadius}, kRadius)}};
  hit.scene.way = -Eigen::Vector3d::UnitZ();
  hit.depth = 0.002;
  ContactWalk walk(solver, [&](double t) { return obstacle_at(hit.scene, t * hit.depth); }, 0.0,
                   {.spacing = kSpacing});
  REQUIRE(walk.advance(1.0));
  const double at_rest = walk.now().force.norm();
  // The lowest mode has 30 Hz and more. A slow ball takes 0.2 s.
  const auto forces_at = [&](double speed, double seconds) {
    hit.speed = speed;
    constexpr double kStep = 1e-3;
    ImplicitDynamics dynamics(model, 1070, {modes.omega, modes.shapes, 0.1}, {.time_step = kStep});
    return means_of_groups(hit_in_full(dynamics, hit, kSpacing, static_cast<int>(seconds / kStep)),
                           2);
  };
  CHECK(obstacle_of(hit, -1).capsules[0].a == hit.scene.touching.capsules[0].a);
  const std::vector<Eigen::Vector3d> slow = forces_at(0.01, 0.3), fast = forces_at(0.5, 0.3);
  INFO("at rest " << at_rest << " N, slow " << slow.back().norm() << " to " << peak_of(slow)
                  << ", fast " << fast.back().norm() << " to " << peak_of(fast));
  CHECK(slow.back().norm() == Approx(at_rest).epsilon(tolerance(1e-3, "gaps, and what rings")));
  CHECK(fast.back().norm() == Approx(at_rest).epsilon(tolerance(1e-2, "what rings")));
  CHECK(peak_of(slow) == Approx(at_rest).epsilon(tolerance(0.05, "a tenth of the mass' force")));
  // The force of the mass rises with the square of the speed or, while waves carry it away, with
  // the speed: at least some ten times from a fiftieth.
  CHECK(peak_of(fast) - at_rest > 10 * (peak_of(slow) - at_rest));
  CHECK(peak_of(fast) > 1.05 * at_rest);
}

}  // namespace
}  // namespace palpable
