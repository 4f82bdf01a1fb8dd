// Friction on bodies with tables: of a sheet by balls.

#include "palpable/common/contact/capsule_obstacles.h"
#include "palpable/common/response/touch_solver.h"
#include "tests/support/allocations.h"
#include "tests/support/elastic_cushion.h"
#include "tests/support/elastic_sheet.h"
#include "tests/support/rubbing.h"
#include "tests/support/some_touch_tables.h"
#include "tests/support/test.h"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <map>
#include <numeric>
#include <optional>
#include <random>
#include <span>
#include <utility>
#include <vector>

namespace palpable {
namespace {

using Eigen::Matrix3Xf;
using Eigen::Vector3d;
using Eigen::Vector3f;
using test::ElasticCushion;
using test::ElasticSheet;
using test::Rubbing;
using test::tolerance;
using test::with_friction;

double largest_difference(const Matrix3Xf& a, const Matrix3Xf& b) {
  return static_cast<double>((a - b).colwise().norm().maxCoeff());
}

// A flat sheet that is pressed from above by balls. More of its points press than of a cushion's,
// and they are its vertices.
class RubbedSheet {
 public:
  explicit RubbedSheet(double mu, double ball = 0.03)
      : radius_(ball), solver(body.skin, body.fixed, body.tables, with_friction(mu)) {}

  // Capsules whose lower ends are balls with these lowest points, m.
  void advance(std::initializer_list<Vector3d> lowest) {
    std::vector<Capsule> balls;
    for (const Vector3d& x : lowest) {
      const Vector3d centre = x + Vector3d(0, 0, radius_);
      balls.push_back({centre, centre + Vector3d(0, 0, 0.04), radius_, radius_});
    }
    report = solver.advance(state, rubbing_.at(std::move(balls)));
  }
  void advance(double x, double y, double depth) { advance({Vector3d(x, y, -depth)}); }

  // m, positions of the points that press.
  [[nodiscard]] std::map<int, Vector3f> pressed_places() const {
    std::vector<Vector3f> moved;
    solver.find_moved(state, moved);
    std::map<int, Vector3f> places;
    for (std::size_t k = 0; k < moved.size(); ++k) {
      const int point = state.forces[k].point;
      places[point] = solver.places().col(point) + moved[k];
    }
    return places;
  }
  // N, of the points with x below `below`, m.
  [[nodiscard]] double friction_along_x(float below = 1) const {
    double sum = 0;
    for (const PointForce& at : state.forces) {
      if (solver.places()(0, at.point) < below) sum += static_cast<double>(at.friction.x());
    }
    return sum;
  }
  // J; the sheet is linear.
  [[nodiscard]] double stored() const {
    std::vector<Vector3f> moved;
    solver.find_moved(state, moved);
    double twice = 0;
    for (std::size_t k = 0; k < moved.size(); ++k) {
      twice += static_cast<double>(state.forces[k].force.dot(moved[k]));
    }
    return 0.5 * twice;
  }

 private:
  double radius_;
  Rubbing rubbing_;

 public:
  ElasticSheet body;
  TouchSolver solver;
  TouchState state;
  TouchReport report;
};

// J, the work of a ball on a sheet by its way and the resultant force, and what the frames
// dissipated.
class Energies {
 public:
  void advance(RubbedSheet& sheet, double x, double y, double depth) {
    sheet.advance(x, y, depth);
    Vector3d force = Vector3d::Zero();
    for (const PointForce& at : sheet.state.forces) force += at.force.cast<double>();
    const Vector3d at(x, y, -depth);
    if (at_) {
      work += 0.5 * (force + force_).dot(at - *at_);
      dissipated += sheet.report.dissipated;
    }
    at_ = at;
    force_ = force;
  }
  double work = 0, dissipated = 0;

 private:
  std::optional<Vector3d> at_;
  Vector3d force_ = Vector3d::Zero();
};

TEST_CASE("what a ball did when it has gone to and fro is what friction dissipated",
          "[contact][friction]") {
  const auto go = [](double mu) {
    RubbedSheet sheet(mu);
    Energies energies;
    constexpr double kStep = 0.0002;
    for (int k = -1; k <= 15; ++k) energies.advance(sheet, 0, 0, kStep * k);
    for (int k = 1; k <= 15; ++k) energies.advance(sheet, kStep * k, 0, 15 * kStep);
    for (int k = 14; k >= 0; --k) energies.advance(sheet, kStep * k, 0, 15 * kStep);
    for (int k = 14; k >= -4; --k) energies.advance(sheet, 0, 0, kStep * k);
    CHECK(sheet.state.forces.empty());
    return energies;
  };
  const Energies rubbed = go(0.5), free = go(0);
  REQUIRE(rubbed.dissipated > 1e-3);
  CHECK(rubbed.work == Approx(rubbed.dissipated)
                           .epsilon(tolerance(0.06,
                                              "2 % in frames of 0.2 mm, "
                                              "half in half of that")));
  CHECK(free.dissipated == 0);
  CHECK(std::abs(free.work) < tolerance(0.05, "frames of 0.2 mm") * rubbed.work);
}

TEST_CASE("the work of a ball in random frames is stored or dissipated", "[contact][friction]") {
  for (unsigned seed = 0; seed < 6; ++seed) {
    INFO("seed " << seed);
    auto random = test::random_case(seed);
    std::uniform_real_distribution<double> moves(-0.0003, 0.0003);
    RubbedSheet sheet(0.2 + 0.15 * seed);
    Energies energies;
    double x = 0, y = 0, depth = 0.0015;
    for (int k = -1; k <= 10; ++k) energies.advance(sheet, x, y, depth / 10 * k);
    for (int frame = 0; frame < 40; ++frame) {
      x += moves(random);
      y += moves(random);
      depth = std::clamp(depth + moves(random), 0.0005, 0.004);
      energies.advance(sheet, x, y, depth);
    }
    const double gone = sheet.stored() + energies.dissipated;
    INFO("work " << energies.work << ", dissipated " << energies.dissipated << " J");
    REQUIRE(energies.dissipated > 0);
    CHECK(energies.work > (1 - tolerance(0.1, "frames of 0.3 mm, compliance of 1 %")) * gone);
    CHECK(energies.work < (1 + tolerance(0.2, "likewise; most in a seed of four: 8 %")) * gone);
  }
}

// Checks that friction of the points that slid in a frame acts against their slip; returns how many
// there are. @param way  m, of the ball in the frame  @param before  pressed_places() before it
int check_slips(const RubbedSheet& sheet, double mu, const Vector3f& way,
                const std::map<int, Vector3f>& before) {
  int count = 0;
  const std::map<int, Vector3f> now = sheet.pressed_places();
  for (const PointForce& at : sheet.state.forces) {
    const Vector3f pressing = at.force - at.friction, n = pressing.normalized();
    const auto old = before.find(at.point);
    const bool is_at_bound = at.friction.norm() > 0.999f * static_cast<float>(mu) * pressing.norm();
    if (old == before.end() || !is_at_bound) continue;
    Vector3f slip = now.at(at.point) - old->second - way;
    slip -= slip.dot(n) * n;
    if (slip.norm() < 2e-4f) continue;
    ++count;
    CHECK(at.friction.dot(slip) < -(1 - tolerance(0.05f, "elastic slip, a normal that turned")) *
                                      at.friction.norm() * slip.norm());
  }
  return count;
}

TEST_CASE("over random frames friction acts against the slip", "[contact][friction]") {
  for (unsigned seed = 0; seed < 4; ++seed) {
    INFO("seed " << seed);
    auto random = test::random_case(seed);
    std::uniform_real_distribution<double> moves(-0.0008, 0.0008);
    const double mu = 0.1 + 0.1 * seed;
    RubbedSheet sheet(mu);
    double x = 0, y = 0, depth = 0.002;
    for (int k = 1; k <= 4; ++k) sheet.advance(x, y, depth / 4 * k);
    int slid = 0;
    for (int frame = 0; frame < 25; ++frame) {
      INFO("frame " << frame);
      const double dx = moves(random), dy = moves(random);
      const double deeper = std::clamp(depth + moves(random), 0.001, 0.004);
      const Vector3d way(dx, dy, depth - deeper);
      x += dx;
      y += dy;
      depth = deeper;
      const auto before = sheet.pressed_places();
      sheet.advance(x, y, depth);
      slid += check_slips(sheet, mu, way.cast<float>(), before);
    }
    CHECK(slid > 0);
  }
}

TEST_CASE("a ball that holds the skin aside keeps it when another one jumps",
          "[contact][friction]") {
  constexpr double kApartX = 0.012, kHigh = 0.0005, kDepth = 0.003, kAside = 0.0005;
  const auto held = [&](int frames) {
    RubbedSheet sheet(2, 0.015);
    const auto advance = [&](double aside, double depth, double other) {
      sheet.advance({Vector3d(aside - kApartX, 0, -depth), Vector3d(kApartX, 0, -other)});
    };
    for (int k = 1; k <= 6; ++k) advance(0, kDepth / 6 * k, -kHigh);
    for (int k = 1; k <= 5; ++k) advance(kAside / 5 * k, kDepth, -kHigh);
    const double before = sheet.friction_along_x(0);
    for (int k = 1; k <= frames; ++k) {
      advance(kAside, kDepth, -kHigh + (kHigh + kDepth) / frames * k);
    }
    if (frames == 1) CHECK(sheet.report.steps > 1);
    return std::pair(before, sheet.friction_along_x(0));
  };
  const auto [began, slowly] = held(14);
  const auto [same, jumped] = held(1);
  REQUIRE(began > 0.1);
  REQUIRE(began == same);
  REQUIRE(slowly > began);  // the other one holds its side of the skin
  CHECK(jumped == Approx(slowly).epsilon(
                      tolerance(0.04, "1 %; 40 % if load steps lose what the first one holds")));
}

TEST_CASE("an obstacle that comes deeper than a load step drags as in small frames",
          "[contact][friction]") {
  constexpr double kX = 0.001, kY = 0.0007, kDepth = 0.0004, kDeeper = 0.0013, kAside = 0.0004;
  const auto pressed = [](int frames, Matrix3Xf& u) {
    RubbedSheet sheet(1);
    for (int k = -1; k <= 5; ++k) sheet.advance(kX, kY, kDepth / 5 * k);
    for (int k = 1; k <= frames; ++k) {
      const double share = static_cast<double>(k) / frames;
      sheet.advance(kX + kAside * share, kY, kDepth + kDeeper * share);
    }
    CHECK(sheet.report.steps == (frames == 1 ? 2 : 1));
    u = sheet.state.u;
    return sheet.friction_along_x();
  };
  Matrix3Xf by_one, by_ten;
  const double one = pressed(1, by_one), ten = pressed(10, by_ten);
  REQUIRE(ten > 0.1);
  CHECK(one ==
        Approx(ten).epsilon(tolerance(0.02, "0.1 %; 5 % if its way is halved between both steps")));
  CHECK(largest_difference(by_one, by_ten) < tolerance(2e-5, "m: 1e-6, and 6e-5"));
}

TEST_CASE("points that are pressed for the first time are met on their way, in frames of any size",
          "[contact][friction]") {
  const auto pressed = [](double step, Matrix3Xf& u) {
    constexpr double kX = 0.001, kY = 0.0007, kDepth = 0.003, kSlope = 0.5;
    RubbedSheet sheet(0.5);
    for (double d = -0.3 * step; d < kDepth; d += step) sheet.advance(kX + kSlope * d, kY, d);
    sheet.advance(kX + kSlope * kDepth, kY, kDepth);
    u = sheet.state.u;
    return sheet.friction_along_x();
  };
  Matrix3Xf in_few, in_many;
  const double few = pressed(0.0011, in_few), many = pressed(0.0001, in_many);
  REQUIRE(many > 0.5);
  CHECK(few == Approx(many).epsilon(
                   tolerance(0.03, "0.5 %; 9 % if they are met on the line to where they end")));
  CHECK(largest_difference(in_few, in_many) < tolerance(4e-5, "m: 1.2e-5, and 1.2e-4"));
}

// A ball whose surface is exact and whose curvature is too small by turns, as that of a surface
// which a camera sees may be.
class Flickering : public Obstacles {
 public:
  void set(const CapsuleObstacles& ball, bool is_flat) {
    ball_ = &ball;
    is_flat_ = is_flat;
  }
  void find_gaps(std::span<const Vector3f> places, std::span<SurfaceGap> gaps) const override {
    ball_->find_gaps(places, gaps);
    if (!is_flat_) return;
    for (SurfaceGap& gap : gaps) gap.curvature /= 1.9f;
  }
  [[nodiscard]] bool may_be_within(const Vector3f& place, float reach) const override {
    return ball_->may_be_within(place, reach);
  }
  [[nodiscard]] float largest_friction(float of_body) const override {
    return ball_->largest_friction(of_body);
  }
  [[nodiscard]] std::optional<MaterialPoint> carried(const MaterialPoint& before) const override {
    return ball_->carried(before);
  }
  [[nodiscard]] std::optional<Vector3f> way_of(const MaterialPoint& now) const override {
    return ball_->way_of(now);
  }

 private:
  const CapsuleObstacles* ball_ = nullptr;
  bool is_flat_ = false;
};

TEST_CASE("points with an anchor stay contacts where the curvature is uncertain",
          "[contact][friction]") {
  // Which points press, in frames with the true curvature and in those with a smaller one.
  const auto points_of = [](double mu) {
    const ElasticSheet sheet;
    TouchSettings settings = with_friction(mu);
    // The ball needs the points of level 3 mm, one that is half as sharp those of 4.2 mm.
    settings.entry = 1.08e-4;
    TouchSolver solver(sheet.skin, sheet.fixed, sheet.tables, settings);
    TouchState state;
    Rubbing ball;
    Flickering flickering;
    std::pair<std::vector<int>, std::vector<int>> points;
    for (int frame = 0; frame < 14; ++frame) {
      const bool is_flat = frame > 4 && frame % 2 == 1;
      constexpr double kBall = 0.03;
      const Vector3d centre(0.001, 0, kBall - std::min(0.003, 0.001 * frame));
      flickering.set(ball.at({Capsule{centre, centre + Vector3d(0, 0, 0.04), kBall, kBall}}),
                     is_flat);
      solver.advance(state, flickering);
      std::vector<int>& of_frame = is_flat ? points.second : points.first;
      of_frame.clear();
      for (const PointForce& at : state.forces) of_frame.push_back(at.point);
    }
    return points;
  };
  const auto [sharp, flat] = points_of(0);
  REQUIRE(flat.size() < sharp.size());  // else nothing is shown by what follows
  const auto [sharp_rubbing, flat_rubbing] = points_of(0.5);
  CHECK(sharp_rubbing == flat_rubbing);
}

TEST_CASE("a body with a coefficient has its room before something rubs it",
          "[contact][friction]") {
  for (const bool has_region : {false, true}) {
    INFO("with a region: " << has_region);
    ElasticCushion cushion;
    if (has_region) test::add_region_all_over(cushion.tables, 1e-3f);
    TouchSolver solver(cushion.skin, cushion.fixed, cushion.tables, with_friction(0.5));
    TouchState state;
    Rubbing slippery(0), rough;
    for (const double depth : {0.001, 0.003, 0.003}) {
      solver.advance(state, slippery.at(0, 0, depth));
    }
    rough.at(0, 0, 0.003);
    for (int frame = 0; frame < 3; ++frame) {
      const CapsuleObstacles& here = rough.at(0.0003 * frame, 0, 0.003);
      CHECK(test::allocations_during([&] { solver.advance(state, here); }) == 0);
    }
    CHECK(state.forces.front().friction.norm() > 0);
    CHECK(state.anchors.size() == state.forces.size());
  }
}

}  // namespace
}  // namespace palpable
