#include "palpable/common/response/touch_solver.h"

#include "tests/support/allocations.h"
#include "tests/support/pressed_sheet.h"
#include "tests/support/test.h"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

namespace palpable {
namespace {

using Eigen::Matrix3f;
using Eigen::Matrix3Xf;
using Eigen::Vector3f;
using test::ElasticSheet;
using test::GapFunction;
using test::tolerance;

struct Sheet : test::PressedSheet {
  // G f of a state's forces; contact points are the vertices.
  [[nodiscard]] Eigen::VectorXd linear_response(const TouchSolver& solver,
                                                const TouchState& state) const {
    Eigen::VectorXd f = Eigen::VectorXd::Zero(body.G.cols());
    for (const PointForce& force : state.forces) {
      const SkinPoint& point = solver.points()[static_cast<std::size_t>(force.point)];
      for (std::size_t k = 0; k < 3; ++k) {
        const double weight = static_cast<double>(point.weights[static_cast<int>(k)]);
        f.segment<3>(3 * point.corners[k]) += weight * force.force.cast<double>();
      }
    }
    return body.G * f;
  }
};

// Largest distance between two displacement fields at a vertex, m.
double apart(const Matrix3Xf& a, const Matrix3Xf& b) {
  return static_cast<double>((a - b).colwise().norm().maxCoeff());
}

TEST_CASE("a pressed sheet holds the conditions of unilateral contact", "[contact]") {
  const Sheet sheet;
  TouchSolver solver = sheet.solver();
  TouchState state;
  const GapFunction gap = test::ball_into_sheet(0.02f, 0.003f);
  const TouchReport report = solver.advance(state, gap);
  REQUIRE(state.forces.size() >= 4);
  SurfaceGap found;
  std::vector<bool> presses(solver.points().size(), false);
  for (const PointForce& force : state.forces) {
    const SkinPoint& point = solver.points()[static_cast<std::size_t>(force.point)];
    const Vector3f x = point.at(sheet.body.skin.vertices.cast<float>()) + point.at(state.u);
    REQUIRE(gap(x, found));
    presses[static_cast<std::size_t>(force.point)] = true;
    CHECK(std::abs(found.distance) < tolerance(2e-5, "m: the last step of Newton's method"));
    CHECK(force.force.dot(found.normal) > 0.0f);
    CHECK(force.force.normalized().dot(found.normal) >
          1 - tolerance(1e-4, "the object turns by its curvature in the last step"));
  }
  for (std::size_t p = 0; p < presses.size(); ++p) {
    const SkinPoint& point = solver.points()[p];
    const Vector3f x = point.at(sheet.body.skin.vertices.cast<float>()) + point.at(state.u);
    if (gap(x, found)) CHECK(found.distance > -tolerance(2e-5, "m"));
  }
  CHECK(report.penetration < tolerance(2e-5, "m"));
  CHECK((state.u.reshaped().cast<double>() - sheet.linear_response(solver, state))
            .cwiseAbs()
            .maxCoeff() < tolerance(2e-6, "m: 3e-4 of 3 mm, and no more"));
}

// A finer sheet, `height` (m) above the elastic one.
SurfaceMesh finer_sheet(double height) {
  constexpr int kSide = 2 * ElasticSheet::kSide - 1;
  SurfaceMesh fine;
  fine.vertices.resize(3, kSide * kSide);
  for (int v = 0; v < kSide * kSide; ++v) {
    const int column = v % kSide - kSide / 2, row = v / kSide - kSide / 2;
    fine.vertices.col(v) << ElasticSheet::kEdge / 2 * column, ElasticSheet::kEdge / 2 * row, height;
  }
  fine.triangles.resize(3, 2 * (kSide - 1) * (kSide - 1));
  int t = 0;
  for (int y = 0; y + 1 < kSide; ++y) {
    for (int x = 0; x + 1 < kSide; ++x) {
      const int v = y * kSide + x;
      fine.triangles.col(t++) << v, v + 1, v + kSide + 1;
      fine.triangles.col(t++) << v, v + kSide + 1, v + kSide;
    }
  }
  return fine;
}

TEST_CASE("nothing enters a fine skin that the elastic one carries", "[contact][carried]") {
  constexpr double kHeight = 0.0015;
  const Sheet sheet;
  const SurfaceMesh fine = finer_sheet(kHeight);
  TouchTables tables = sheet.body.tables;
  tables.point_spacing = 0.003;  // the fine vertices alone
  tables.coarse = {sheet.body.skin, sheet.body.fixed};
  const std::vector<std::uint8_t> free(static_cast<std::size_t>(fine.vertex_count()), 0);
  TouchSolver solver(fine, free, tables, sheet.settings);
  REQUIRE(solver.points().size() == free.size());
  Matrix3Xf skin(3, fine.vertex_count());
  TouchState state;
  solver.place(state, skin);
  CHECK(skin == fine.vertices.cast<float>());

  const GapFunction gap =
      test::ball_into_sheet(0.02f, 0.003f, Vector3f(0.001f, 0, static_cast<float>(kHeight)));
  for (int frame = 0; frame < 6; ++frame) solver.advance(state, gap);  // normals are a frame's old
  REQUIRE(state.forces.size() >= 4);
  solver.place(state, skin);
  SurfaceGap found;
  float nearest = 1;
  for (const auto& x : skin.colwise()) {
    if (gap(x, found)) nearest = std::min(nearest, found.distance);
  }
  CHECK(std::abs(nearest) < tolerance(2e-5, "m: the last step of Newton's method"));
  // The coarse vertices respond to the forces at the corners that the points are attached to.
  CHECK((state.u.reshaped().cast<double>() - sheet.linear_response(solver, state))
            .cwiseAbs()
            .maxCoeff() < tolerance(2e-6, "m: 3e-4 of 3 mm, and no more"));
  // The displacements of the pressed points are those of the skin.
  std::vector<Vector3f> moved;
  solver.find_moved(state, moved);
  REQUIRE(moved.size() == state.forces.size());
  for (std::size_t k = 0; k < moved.size(); ++k) {
    const Vector3f x = solver.places().col(state.forces[k].point) + moved[k];
    CHECK((skin.colwise() - x).colwise().norm().minCoeff() < tolerance(1e-7, "m: rounding"));
  }
  CHECK(test::allocations_during([&] {
          solver.advance(state, gap);
          solver.place(state, skin);
          solver.find_moved(state, moved);
        }) == 0);
}

TEST_CASE("an obstacle that comes in one frame gives the same state as one that came slowly",
          "[contact]") {
  const Sheet sheet;
  TouchSolver slow = sheet.solver(), fast = sheet.solver();
  TouchState slowly, at_once;
  for (int frame = 1; frame <= 20; ++frame) {
    slow.advance(slowly, test::ball_into_sheet(0.02f, 0.00025f * static_cast<float>(frame)));
  }
  const TouchReport report = fast.advance(at_once, test::ball_into_sheet(0.02f, 0.005f));
  CHECK(report.steps == 4);
  CHECK(apart(slowly.u, at_once.u) < tolerance(4e-5, "m: twice the last step's"));
}

TEST_CASE("an object deeper than a frame's steps is reached in the frames after", "[contact]") {
  Sheet sheet;
  sheet.settings.most_steps = 2;
  const Sheet usual;
  TouchSolver solver = sheet.solver(), whole = usual.solver();
  TouchState state, wanted;
  whole.advance(wanted, test::ball_into_sheet(0.02f, 0.005f));
  const TouchReport first = solver.advance(state, test::ball_into_sheet(0.02f, 0.005f));
  CHECK(first.penetration == Approx(0.0025).margin(tolerance(2e-4, "m: two steps of four")));
  solver.advance(state, test::ball_into_sheet(0.02f, 0.005f));
  CHECK(apart(state.u, wanted.u) < tolerance(4e-5, "m: twice the last step's"));
}

TEST_CASE("an obstacle that leaves releases the skin at once, without pulling", "[contact]") {
  const Sheet sheet;
  for (const GapFunction& gap : {test::nothing_near(), test::ball_into_sheet(0.02f, -0.005f)}) {
    TouchSolver solver = sheet.solver();
    TouchState state;
    solver.advance(state, test::ball_into_sheet(0.02f, 0.004f));
    REQUIRE(state.u.cwiseAbs().maxCoeff() > 0.003f);
    solver.advance(state, gap);
    CHECK(state.forces.empty());
    CHECK(state.u.isZero(0));
  }
}

TEST_CASE("a fast object that leaves stays the skin's obstacle", "[contact]") {
  const Sheet sheet;
  TouchSolver solver = sheet.solver(), other = sheet.solver();
  TouchState state, wanted;
  solver.advance(state, test::ball_into_sheet(0.02f, 0.006f));
  // Its points are farther from the ball than the search band, and would spring through it.
  solver.advance(state, test::ball_into_sheet(0.02f, 0.0015f));
  other.advance(wanted, test::ball_into_sheet(0.02f, 0.0015f));
  REQUIRE(wanted.u.cwiseAbs().maxCoeff() > 0.001f);
  CHECK(apart(state.u, wanted.u) < tolerance(4e-5, "m: twice the last step's"));
}

TEST_CASE("no vertex moves farther in a frame than it may, and the rest is made up for",
          "[contact]") {
  const Sheet sheet;
  TouchSolver solver = sheet.solver(), other = sheet.solver();
  constexpr double kMost = 0.002;  // m
  TouchState state, wanted;
  other.advance(wanted, test::ball_into_sheet(0.02f, 0.005f));
  const auto goes_to = [&](const GapFunction& gap, const Matrix3Xf& target) {
    for (int frame = 0; frame < 4; ++frame) {
      const Matrix3Xf before = state.u.cols() > 0 ? state.u : Matrix3Xf::Zero(3, target.cols());
      const TouchReport report = solver.advance(state, gap, kMost);
      CHECK(apart(state.u, before) < kMost + tolerance(1e-6, "m: rounding"));
      if (frame == 0) CHECK(apart(state.u, before) > 0.9 * kMost);
      if (frame == 3) CHECK(report.left_to_move == 0.0);
    }
    CHECK(apart(state.u, target) < tolerance(4e-5, "m: twice the last step's"));
  };
  goes_to(test::ball_into_sheet(0.02f, 0.005f), wanted.u);
  goes_to(test::nothing_near(), Matrix3Xf::Zero(3, wanted.u.cols()));
  CHECK(state.forces.empty());
  // From side to side: the forces of both are remembered, and those of the first are let go.
  goes_to(test::ball_into_sheet(0.01f, 0.002f, Vector3f(-0.012f, 0, 0)), [&] {
    TouchState left;
    other.advance(left, test::ball_into_sheet(0.01f, 0.002f, Vector3f(-0.012f, 0, 0)));
    return left.u;
  }());
}

TEST_CASE("a solution that a frame's iterations do not reach is reached in later frames",
          "[contact]") {
  Sheet sheet;
  sheet.settings.last_iterations = 1;
  const Sheet usual;
  TouchSolver solver = sheet.solver(), other = usual.solver();
  TouchState state, wanted;
  other.advance(wanted, test::ball_into_sheet(0.02f, 0.001f));
  const TouchReport first = solver.advance(state, test::ball_into_sheet(0.02f, 0.001f));
  CHECK(first.iterations == 1);
  REQUIRE(first.last_change > 0.0005);
  CHECK(first.left_to_move > 0);
  CHECK_FALSE(first.stated.has_value());
  for (int frame = 0; frame < 10; ++frame)
    solver.advance(state, test::ball_into_sheet(0.02f, 0.001f));
  CHECK(apart(state.u, wanted.u) < tolerance(4e-5, "m: twice the last step's"));
}

TEST_CASE("gaps that are NaN press nothing", "[contact]") {
  const Sheet sheet;
  TouchSolver solver = sheet.solver();
  TouchState state;
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  solver.advance(state, GapFunction([&](const Vector3f&, SurfaceGap& gap) {
                   gap.distance = kNaN;
                   return true;
                 }));
  CHECK(state.u.isZero(0));
  solver.advance(state, GapFunction([&](const Vector3f&, SurfaceGap& gap) {
                   gap.distance = -0.001f;
                   gap.normal.setConstant(kNaN);
                   return true;
                 }));
  CHECK(state.u.isZero(0));
}

TEST_CASE("the same frame and state give the same bytes, without allocating", "[contact]") {
  const Sheet sheet;
  TouchSolver one = sheet.solver(), other = sheet.solver();
  TouchState a, b;
  // The other has solved other frames before, which must not matter.
  other.advance(b, test::ball_into_sheet(0.01f, 0.002f, Vector3f(0.012f, 0, 0)));
  other.advance(b, test::nothing_near());
  other.advance(b, test::nothing_near());
  for (int frame = 0; frame < 10; ++frame) {
    const auto x = 0.001f * static_cast<float>(frame);
    const GapFunction gap = test::ball_into_sheet(0.02f, 0.003f, Vector3f(x, 0, 0));
    one.advance(a, gap);
    other.advance(b, gap);
    CHECK(a.u == b.u);
  }
  const GapFunction gap = test::ball_into_sheet(0.02f, 0.004f, Vector3f(0.006f, 0.003f, 0));
  CHECK(test::allocations_during([&] { one.advance(a, gap); }) == 0);
  const GapFunction leaving = test::ball_into_sheet(0.02f, 0.001f);
  CHECK(test::allocations_during([&] { one.advance(a, leaving, 0.001); }) == 0);
}

TEST_CASE("a state comes with a stated error, by the factors of the held-out touches",
          "[contact]") {
  Sheet sheet;
  sheet.settings.softness = 0.05;
  for (int k = 0; k < kLeastTouches; ++k) {
    sheet.body.tables.held_out.push_back({PressingThing::kFinger, 0.004, 0.03, 0.02, 0.09, 0.02});
  }
  TouchSolver solver = sheet.solver();
  TouchState state;
  CHECK_FALSE(solver.advance(state, test::nothing_near()).stated.has_value());
  const TouchReport report = solver.advance(state, test::ball_into_sheet(0.02f, 0.003f));
  REQUIRE(report.stated.has_value());
  const double largest = static_cast<double>(state.u.colwise().norm().maxCoeff());
  CHECK(report.indicators.entry == Approx(report.penetration / largest));
  CHECK(report.indicators.entry > 0.01);
  CHECK(report.indicators.beyond == 0.0);  // the sheet's tables are linear
  CHECK(report.indicators.cross == 0.0);
  // The touches' errors are 1.5 times their indicators, those of their stress 4.5 times.
  CHECK(report.stated->displacement ==
        Approx(kOnTheSafeSide * 1.5 * unscaled_error(report.indicators)));
  CHECK(report.stated->von_mises ==
        Approx(kOnTheSafeSide * 4.5 * unscaled_error(report.indicators)));
  const GapFunction deeper = test::ball_into_sheet(0.02f, 0.0031f);
  CHECK(test::allocations_during([&] { solver.advance(state, deeper); }) == 0);
  // While the step limit holds, the state is not the solution yet.
  CHECK_FALSE(
      solver.advance(state, test::ball_into_sheet(0.02f, 0.006f), 0.001).stated.has_value());
  CHECK_FALSE(solver.advance(state, test::nothing_near()).stated.has_value());
  sheet.body.tables.held_out.pop_back();
  TouchSolver too_few = sheet.solver();
  TouchState other;
  CHECK_FALSE(too_few.advance(other, test::ball_into_sheet(0.02f, 0.003f)).stated.has_value());
}

TEST_CASE("two obstacles press at a time, and two coincident ones as one", "[contact]") {
  const Sheet sheet;
  const GapFunction left = test::ball_into_sheet(0.008f, 0.002f, Vector3f(-0.014f, 0, 0));
  const GapFunction right = test::ball_into_sheet(0.008f, 0.003f, Vector3f(0.014f, 0, 0));
  const auto both = [](const GapFunction& a, const GapFunction& b) -> GapFunction {
    return [a, b](const Vector3f& x, SurfaceGap& gap) {
      SurfaceGap other;
      const bool one = a(x, gap), two = b(x, other);
      if (two && (!one || other.distance < gap.distance)) gap = other;
      return one || two;
    };
  };
  TouchSolver solver = sheet.solver(), alone = sheet.solver();
  TouchState state, single;
  solver.advance(state, both(left, right));
  SurfaceGap gap;
  int of_left = 0, of_right = 0;
  for (const PointForce& force : state.forces) {
    const int vertex = solver.points()[static_cast<std::size_t>(force.point)].corners[0];
    (sheet.body.skin.vertices(0, vertex) < 0 ? of_left : of_right) += 1;
  }
  CHECK(of_left >= 2);
  CHECK(of_right >= 2);
  state = {};
  solver.advance(state, both(left, left));
  alone.advance(single, left);
  CHECK(state.u == single.u);
}

TEST_CASE("of too many contact points the deepest are kept, and the others are counted",
          "[contact]") {
  Sheet sheet;
  sheet.body.tables.point_spacing = 0.0013;  // some 1,500 points
  sheet.settings.entry = 1e-9;               // all of them
  TouchSolver solver = sheet.solver();
  TouchState state;
  const TouchReport report = solver.advance(state, test::ball_into_sheet(0.5f, 0.001f));
  CHECK(report.candidates <= TouchSolver::kMostPoints);
  CHECK(report.dropped > 0);
  CHECK(state.u.allFinite());
}

TEST_CASE("a flat obstacle presses fewer points, and enters between them no deeper than allowed",
          "[contact]") {
  Sheet fine, coarse;
  for (Sheet* sheet : {&fine, &coarse}) {
    sheet->body.tables.point_spacing = 0.0013;
    sheet->settings.softness = 1e-3;  // ten points between two vertices share a force
  }
  fine.settings.entry = 1e-9;
  coarse.settings.entry = 1e-4;
  TouchSolver all = fine.solver(), some = coarse.solver();
  const GapFunction gap = test::ball_into_sheet(0.04f, 0.003f);
  TouchState with_all, with_some;
  const TouchReport dense = all.advance(with_all, gap);
  const TouchReport sparse = some.advance(with_some, gap);
  CHECK(sparse.candidates < 0.6 * dense.candidates);
  SurfaceGap found;
  float deepest = 0;
  for (const SkinPoint& point : all.points()) {
    const Vector3f x = point.at(coarse.body.skin.vertices.cast<float>()) + point.at(with_some.u);
    if (gap(x, found)) deepest = std::max(deepest, -found.distance);
  }
  CHECK(deepest < 1.3e-4f);
  CHECK(apart(with_all.u, with_some.u) < tolerance(2e-4, "m: twice what may enter"));
}

TEST_CASE("a gap is not queried again where its normal and curvature give it", "[contact]") {
  const Sheet sheet;
  TouchSolver solver = sheet.solver();
  TouchState state;
  int queried = 0;
  const GapFunction there = test::ball_into_sheet(0.02f, 0.003f);
  const GapFunction counting = [&](const Vector3f& x, SurfaceGap& gap) {
    ++queried;
    return there(x, gap);
  };
  solver.advance(state, counting);
  queried = 0;
  const TouchReport report = solver.advance(state, counting);  // nothing has moved
  REQUIRE(report.candidates > 4);
  const int clusters = queried;
  struct Counting : Obstacles {
    const GapFunction& there;
    mutable int queried = 0, near = 0, judged = 0;
    explicit Counting(const GapFunction& gap) : there(gap) {}
    void find_gaps(std::span<const Vector3f> places, std::span<SurfaceGap> gaps) const override {
      queried += static_cast<int>(places.size());
      there.find_gaps(places, gaps);
    }
    [[nodiscard]] bool may_be_within(const Vector3f& x, float reach) const override {
      SurfaceGap gap;
      ++near;
      return there(x, gap) && gap.distance < reach;
    }
    [[nodiscard]] float depth_at(const Vector3f& x) const override {
      ++judged;
      return there.depth_at(x);
    }
  } counted(there);
  const TouchReport again = solver.advance(state, counted);
  CHECK(counted.queried == again.candidates);  // once each, in several iterations
  CHECK(counted.near > 0);
  CHECK(clusters > counted.queried);
  // The state is judged at points near the obstacle, once each.
  CHECK(counted.judged > 0);
  CHECK(counted.judged <= static_cast<int>(solver.points().size()));
}

TEST_CASE("a query that found no obstacle does not hide one that comes near later", "[contact]") {
  const Sheet sheet;
  TouchSolver one = sheet.solver(), other = sheet.solver();
  const GapFunction::Near always = [](const Vector3f&, float) { return true; };
  TouchState pressed, elsewhere;
  one.advance(pressed, test::ball_into_sheet(0.02f, 0.006f));
  const auto far_away = [](const Vector3f&, SurfaceGap& gap) {
    gap.distance = 0.01f;
    return true;
  };
  other.advance(elsewhere, GapFunction(far_away, always));
  // The ball leaves, and its gaps end a little beyond the search band: the queries of all points
  // return nothing, and then the skin springs back into it.
  const GapFunction there(test::gap_to_ball(Vector3f(0, 0, 0.017f), 0.02f, 0.0026f), always);
  TouchState a = pressed, b = pressed;
  one.advance(a, there);
  other.advance(b, there);
  REQUIRE(a.u.cwiseAbs().maxCoeff() > 0.002f);
  CHECK(a.u == b.u);
}

TEST_CASE("a surface that moves away does not come back by its curvature", "[contact]") {
  const Sheet sheet;
  // A ball presses the sheet down, away from a roof beside it that is near, too.
  const GapFunction pressing = test::ball_into_sheet(0.005f, 0.00125f);
  const GapFunction with_roof = [&](const Vector3f& x, SurfaceGap& gap) {
    const float to_roof = 0.0024f - x.z();
    if (pressing(x, gap) && gap.distance <= to_roof) return true;
    gap.distance = to_roof;
    gap.normal = -Vector3f::UnitZ();
    gap.curvature = -4e4f * Matrix3f::Identity();
    return true;
  };
  TouchSolver one = sheet.solver(), other = sheet.solver();
  TouchState state, wanted;
  one.advance(state, with_roof);
  other.advance(wanted, pressing);
  CHECK(apart(state.u, wanted.u) < tolerance(4e-5, "m: twice the last step's"));
}

TEST_CASE("querying may_be_within() first does not change the result", "[contact]") {
  const Sheet sheet;
  TouchSolver with = sheet.solver(), without = sheet.solver();
  TouchState one, other;
  for (const float depth : {0.001f, 0.004f, 0.002f}) {
    const GapFunction gap = test::ball_into_sheet(0.012f, depth);
    const GapFunction near(gap, [&](const Vector3f& x, float reach) {
      SurfaceGap found;
      return gap(x, found) && found.distance < reach;
    });
    with.advance(one, near);
    without.advance(other, GapFunction(gap, [](const Vector3f&, float) { return true; }));
    // A gap queried earlier in the frame nearby is continued by its curvature.
    CHECK(apart(one.u, other.u) < tolerance(1e-6, "m: 5 % of Newton's last step"));
  }
}

}  // namespace
}  // namespace palpable
