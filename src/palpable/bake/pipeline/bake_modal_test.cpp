#include "palpable/bake/pipeline/bake_modal.h"

#include "palpable/bake/solid/contact.h"
#include "palpable/bake/solid/stress.h"
#include "palpable/common/body_file/touch_file.h"
#include "palpable/common/contact/capsule_obstacles.h"
#include "palpable/common/contact/contact_solver.h"
#include "palpable/common/response/modal_body.h"
#include "tests/support/allocations.h"
#include "tests/support/baked_beam.h"
#include "tests/support/ball_gap.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <cmath>
#include <limits>
#include <memory>
#include <vector>

namespace palpable {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Matrix3Xf;
using Eigen::Vector3d;
using Eigen::Vector3f;
using test::baked_beam;
using test::tolerance;

const ModalTables& tables() {
  static const ModalTables one = modal_tables(baked_beam());
  return one;
}

// A finger across the beam, above it: `x` from the support, its lowest line `depth` below the top.
Capsule finger(double x, double depth, double radius = 0.010) {
  const Eigen::AlignedBox3d box = box_of(baked_beam().body.surface);
  const Vector3d at(box.min().x() + x, box.center().y(), box.max().z() + radius - depth);
  return {at - 0.03 * Vector3d::UnitY(), at + 0.03 * Vector3d::UnitY(), radius, radius};
}

CapsuleObstacles obstacle(const Capsule& capsule) {
  CapsuleObstacles obstacles;
  obstacles.set({&capsule, 1});
  return obstacles;
}

// Beams in one solver, with their states.
struct Beams {
  std::vector<std::unique_ptr<ModalBody>> bodies;
  std::vector<ModalState> states;
  std::unique_ptr<ContactSolver> solver;
  ContactReport report;

  explicit Beams(const std::vector<Vector3d>& places,
                 const ModalMember& member = {&baked_beam().body, &tables()},
                 const ModalSettings& settings = {})
      : Beams(std::vector<ModalMember>(places.size(), member), places, settings) {}
  Beams(const std::vector<ModalMember>& members, const std::vector<Vector3d>& places,
        const ModalSettings& settings = {})
      : states(members.size()) {
    std::vector<ContactSolver::Member> all;
    for (std::size_t k = 0; k < members.size(); ++k) {
      const ModalBody* twin =
          k > 0 && are_twins(members[0], members[k]) ? bodies.front().get() : nullptr;
      bodies.push_back(std::make_unique<ModalBody>(members[k], twin, settings));
      bodies.back()->use(states[k]);
      Rigid3 pose = Rigid3::Identity();
      pose.translation() = places[k];
      all.push_back({bodies.back().get(), pose});
    }
    solver = std::make_unique<ContactSolver>(all);
  }
  // Advances a frame; only the last beam has obstacles.
  void advance(const Obstacles& obstacles) {
    near_.assign(bodies.size(), {});
    near_.back().obstacles = &obstacles;
    report = solver->advance(near_);
  }
  // N: the force on a beam by other members, or by obstacles.
  [[nodiscard]] Vector3d force(std::size_t on, bool by_others) const {
    Vector3d sum = Vector3d::Zero();
    for (const PointForce& force : states[on].forces) {
      if ((force.by >= 0) == by_others) sum += force.force.cast<double>();
    }
    if (by_others) {
      for (const PressedPoint& point : solver->pressed_by_others(static_cast<int>(on))) {
        sum += point.force.cast<double>();
      }
    }
    return sum;
  }

 private:
  std::vector<ContactSolver::Near> near_;
};

// Slope dz/dx of the beam's top or underside, over the 60 mm around a position that is given in m
// from the free end.
double slope_of(Beams& beams, std::size_t member, bool top, double from_end) {
  const Matrix3Xf& skin = beams.bodies[member]->place(beams.states[member]);
  const Eigen::AlignedBox3d box = box_of(baked_beam().body.surface);
  const double z = top ? box.max().z() : box.min().z();
  Eigen::Matrix2Xd places(2, 0);
  for (Eigen::Index v = 0; v < skin.cols(); ++v) {
    const Vector3d rest = baked_beam().body.surface.vertices.col(v);
    if (std::abs(rest.z() - z) > 1e-6) continue;
    if (std::abs(box.max().x() - rest.x() - from_end) > 0.03) continue;
    places.conservativeResize(2, places.cols() + 1);
    places.rightCols(1) = Eigen::Vector2d(skin(0, v), skin(2, v));
  }
  const Eigen::Vector2d mean = places.rowwise().mean();
  const Eigen::Matrix2Xd off = places.colwise() - mean;
  return off.row(0).dot(off.row(1)) / off.row(0).squaredNorm();
}

// Presses the beam by a finger that advances by 2 mm a frame.
void press(Beams& beams, double x, double depth) {
  for (double now = 0; now < depth + 1e-9; now += 0.002) beams.advance(obstacle(finger(x, now)));
}

TEST_CASE("a beam under a finger bends as full finite elements say, far and near",
          "[pipeline][modal][long]") {
  const IntrusiveBake& made = baked_beam();
  const EquilibriumSolver solver(made.series.model());
  for (const double x : {0.20, 0.36}) {
    for (const double depth : {0.006, 0.020}) {
      Beams beams({Vector3d::Zero()});
      press(beams, x, depth);
      const auto way = [x](double t) {
        Obstacle obstacle;
        obstacle.capsules = {finger(x, t)};
        return obstacle;
      };
      ContactWalk walk(solver, way, 0.0);
      REQUIRE(walk.advance(depth));
      const Matrix3Xd& u = walk.now().displacement;
      const Matrix3Xf skin = beams.bodies[0]->place(beams.states[0]);
      const Boundary boundary = boundary_of(made.series.model().mesh);
      const Matrix3Xd true_u = u(Eigen::all, boundary.node_of_vertex);
      const Matrix3Xd off = skin.cast<double>() - made.body.surface.vertices - true_u;
      INFO("at " << x << " m, " << depth << " m deep");
      INFO(beams.force(0, false).transpose() << " N, truly " << walk.now().force.transpose());
      INFO(beams.states[0].forces.size() << " points, truly " << walk.now().touching);
      CHECK(off.norm() / true_u.norm() <= tolerance(0.04, "34 modes, no dimple under the finger"));
      // The force depends on the few contact points that such a coarse mesh has there.
      CHECK(std::abs(beams.force(0, false).norm() / walk.now().force.norm() - 1) <=
            tolerance(0.06, "likewise"));
    }
  }
}

TEST_CASE("two beams press each other as hard, enter nothing, and come back", "[pipeline][modal]") {
  Beams beams({{0, 0, 0}, {0, 0, 0.06}});  // 10 mm between them
  bool lay = false;
  double last = 0;
  for (double depth = 0; depth < 0.0301; depth += 0.002) {
    beams.advance(obstacle(finger(0.34, depth)));
    const Vector3d on_lower = beams.force(0, true), on_upper = beams.force(1, true);
    CHECK((on_lower + on_upper).norm() <= tolerance(1e-6, "N: floats of what is equal"));
    CHECK(beams.report.imbalance <= tolerance(1e-6, "N, likewise"));
    CHECK(beams.report.mutual_penetration <= tolerance(5e-4, "m: the half space under a point"));
    if (on_lower.z() < 0) {
      lay = true;
      CHECK(-on_lower.z() >= last * (1 - tolerance(0.02, "it only grows as the finger goes on")));
      last = -on_lower.z();
    }
  }
  CHECK(lay);
  CHECK(last > 0.05);
  // Under an obstacle at rest the state does not change.
  const CapsuleObstacles pressing = obstacle(finger(0.34, 0.030));
  const Eigen::VectorXd q = beams.states[0].q;
  for (int n = 0; n < 5; ++n) beams.advance(pressing);
  CHECK((beams.states[0].q - q).norm() <= tolerance(1e-3, "Newton's method had ended") * q.norm());
  CHECK(beams.report.last_change < 2e-5);
  // The same states give the same bytes, and no memory is allocated.
  const std::vector<ModalState> before = beams.states;
  beams.advance(pressing);
  const std::vector<ModalState> after = beams.states;
  for (const std::size_t k : {0, 1}) {
    beams.states[k].q = before[k].q;
    beams.states[k].forces.assign(before[k].forces.begin(), before[k].forces.end());
  }
  CHECK(test::allocations_during([&] { beams.advance(pressing); }) == 0);
  CHECK(beams.states[0].q == after[0].q);
  CHECK(beams.states[1].q == after[1].q);
  // The finger vanishes.
  for (int n = 0; n < 3; ++n) beams.advance(CapsuleObstacles());
  for (const ModalState& state : beams.states) {
    CHECK(state.forces.empty());
    CHECK(state.q.norm() < 1e-6 * q.norm());
  }
}

TEST_CASE("an end that lies on a face is pressed along the face's normal", "[pipeline][modal]") {
  // The upper one is held farther back.
  Beams beams({{0, 0, 0}, {-0.08, 0, 0.085}});
  for (double depth = 0; depth < 0.0361; depth += 0.003) {
    beams.advance(obstacle(finger(0.34, depth)));
  }
  const Vector3d on_lower = beams.force(0, true);
  REQUIRE(on_lower.z() < -0.05);
  const double face = slope_of(beams, 0, true, 0.08), end = slope_of(beams, 1, false, 0.01);
  REQUIRE(end < face - 0.05);
  CHECK(std::abs(-on_lower.x() / on_lower.z() - face) <=
        tolerance(0.01, "of the slope: the face is curved where its slope is measured"));
}

TEST_CASE("a finger that appears inside the beam leads to a finite state", "[pipeline][modal]") {
  Beams beams({Vector3d::Zero()});
  const CapsuleObstacles deep = obstacle(finger(0.36, 0.009));
  for (int n = 0; n < 3; ++n) beams.advance(deep);
  CHECK(beams.states[0].q.allFinite());
  CHECK(beams.report.penetration < 1e-3);
  CHECK(beams.force(0, false).z() < 0);
}

TEST_CASE("the stress of a bent beam is the full solver's for its shape", "[pipeline][modal]") {
  const IntrusiveBake& made = baked_beam();
  Beams beams({Vector3d::Zero()});
  press(beams, 0.36, 0.016);
  std::vector<float> mises(static_cast<std::size_t>(made.body.surface.vertex_count()));
  beams.bodies[0]->stress(beams.states[0], mises);
  const Eigen::VectorXd u = made.energy_modes * beams.states[0].q;
  const SolidModel& model = made.series.model();
  const Boundary boundary = boundary_of(model.mesh);
  const StressField cauchy = nodal_cauchy_stress(model, u.reshaped(3, u.size() / 3));
  double largest = 0, off = 0;
  for (std::size_t v = 0; v < mises.size(); ++v) {
    const StressField s = cauchy.col(boundary.node_of_vertex[v]);
    const double wanted = von_mises(s)[0];
    largest = std::max(largest, wanted);
    off = std::max(off, std::abs(static_cast<double>(mises[v]) - wanted));
  }
  CHECK(off <= tolerance(1e-3, "floats, strains of 1e-2") * largest);
}

TEST_CASE("asking first whether anything is near changes no byte of the response",
          "[pipeline][modal]") {
  Beams filtered({Vector3d::Zero()}), unfiltered({Vector3d::Zero()});
  int queries = 0;
  for (double depth = -0.002; depth < 0.0141; depth += 0.002) {
    const CapsuleObstacles capsule = obstacle(finger(0.30, depth));
    const auto gap_of = [&](const Vector3f& at, SurfaceGap& gap) {
      gap = gap_at(capsule, at);
      return std::isfinite(gap.distance);
    };
    const test::GapFunction with_filter(gap_of, [&](const Vector3f& at, float reach) {
      ++queries;
      return capsule.may_be_within(at, reach);
    });
    const test::GapFunction without_filter(gap_of, [](const Vector3f&, float) { return true; });
    filtered.advance(with_filter);
    unfiltered.advance(without_filter);
    CHECK(filtered.report.candidates == unfiltered.report.candidates);
    CHECK(filtered.states[0].q == unfiltered.states[0].q);
  }
  CHECK_FALSE(filtered.states[0].forces.empty());
  CHECK(queries > 0);
}

TEST_CASE("beams of the same body share their tables, and deform as two separate ones do",
          "[pipeline][modal]") {
  ReducedBody another = baked_beam().body;
  another.several->energy.K[0] = std::nextafter(another.several->energy.K[0], 1e9);
  const ModalMember lower{&baked_beam().body, &tables()}, twin = lower;
  const ModalMember stranger{&another, &tables()};
  REQUIRE(are_twins(lower, twin));
  REQUIRE_FALSE(are_twins(lower, stranger));
  const std::vector<Vector3d> places{{0, 0, 0}, {0, 0, 0.06}};
  Beams alike({lower, twin}, places), unlike({lower, stranger}, places);
  for (double depth = 0; depth < 0.0201; depth += 0.002) {
    alike.advance(obstacle(finger(0.34, depth)));
    unlike.advance(obstacle(finger(0.34, depth)));
  }
  REQUIRE(alike.force(0, true).norm() > 0.01);
  std::vector<float> mises(static_cast<std::size_t>(another.surface.vertex_count())), other(mises);
  for (const std::size_t k : {0, 1}) {
    CHECK((alike.states[k].q - unlike.states[k].q).norm() <=
          tolerance(1e-9, "the last digit of an energy") * alike.states[k].q.norm());
    alike.bodies[k]->stress(alike.states[k], mises);
    unlike.bodies[k]->stress(unlike.states[k], other);
    const Eigen::Map<const Eigen::VectorXf> one(mises.data(), std::ssize(mises)),
        two(other.data(), std::ssize(other));
    CHECK((one - two).norm() <= static_cast<float>(tolerance(1e-5, "floats")) * one.norm());
  }
}

TEST_CASE("a body file keeps what a beam needs to be touched", "[pipeline][modal]") {
  const test::ScratchFolder folder("modal_file");
  const IntrusiveBake& made = baked_beam();
  write_touchable_body(folder / "beam.palpable", made.body, tables());
  const TouchableBody read = value_or_throw(read_touchable_body(folder / "beam.palpable"));
  REQUIRE(read.modal.has_value());
  CHECK_FALSE(read.touch.has_value());
  CHECK(read.modal->inner_modes == tables().inner_modes);
  CHECK(read.modal->half_space == tables().half_space);
  CHECK(read.modal->shell.elements == tables().shell.elements);
  ModalTables wrong = tables();
  wrong.inner_modes(0, 0) = std::numeric_limits<float>::quiet_NaN();
  CHECK_THROWS_WITH(write_touchable_body(folder / "wrong.palpable", made.body, wrong),
                    Catch::Contains("not finite"));
}

TEST_CASE("a beam ten times as large deforms alike", "[pipeline][modal]") {
  const TouchableBody one(baked_beam().body, {}, tables());
  const TouchableBody large = scaled(one, 10);
  Beams small({Vector3d::Zero()}, {&one.body, &*one.modal});
  ModalSettings settings;
  settings.band *= 10;
  settings.largest_step *= 10;
  settings.tolerance *= 10;
  settings.entry *= 10;
  settings.largest_move *= 10;
  Beams big({Vector3d::Zero()}, {&large.body, &*large.modal}, settings);
  press(small, 0.36, 0.010);
  for (double now = 0; now < 0.0101; now += 0.002) {
    Capsule c = finger(0.36, now);
    c.a *= 10;
    c.b *= 10;
    c.ra *= 10;
    c.rb *= 10;
    big.advance(obstacle(c));
  }
  const double f = small.force(0, false).norm(), F = big.force(0, false).norm();
  CHECK(std::abs(F / (100 * f) - 1) <=
        tolerance(0.05, "contact points of both lie where their meshes have them"));
}

}  // namespace
}  // namespace palpable
