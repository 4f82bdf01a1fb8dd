// Contact between two bodies of one mesh: what each pair is, its forces and their derivative.
#include "palpable/bake/solid/mutual_pairs.h"

#include "palpable/bake/solid/joined_model.h"
#include "tests/support/small_beam.h"
#include "tests/support/test.h"

#include <array>
#include <cstddef>
#include <random>
#include <vector>

namespace palpable {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using test::tolerance;

constexpr double kPenalty = 3e4;

// Two small beams; the second is turned a little and lies `above` (m) over the first's top.
struct TwoBeams {
  SolidModel model;
  Boundary boundary;
  TetAssembly assembly;
  ContactPoints points;
  VectorXd penalties;
  MutualPairs pairs;

  explicit TwoBeams(double above, double angle = 0.1, const Vector3d& aside = Vector3d::Zero(),
                    const Friction& friction = {})
      : model(placed(above, angle, aside)),
        boundary(boundary_of(model.mesh)),
        assembly(model),
        points(contact_points(model.mesh, boundary, 0.01)),
        penalties(VectorXd::Constant(model.mesh.node_count(), kPenalty)),
        pairs(assembly, model.mesh, boundary, points, penalties, 0.03, friction) {}

  static SolidModel placed(double above, double angle, const Vector3d& aside) {
    const std::array<SolidModel, 2> beams{test::small_beam(8, 2, 2), test::small_beam(7, 3, 1)};
    std::array<Rigid3, 2> poses{Rigid3::Identity(), Rigid3::Identity()};
    poses[1].translation() = Vector3d(0, 0, 0.05 + above) + aside;
    poses[1].rotate(Eigen::AngleAxisd(angle, Vector3d::UnitZ()));
    return joined(beams, poses).model;
  }

  [[nodiscard]] const Matrix3Xd& nodes() const { return model.mesh.nodes; }

  // Positions after a smooth displacement of some millimetres, different for the two beams.
  [[nodiscard]] Matrix3Xd bent() const {
    Matrix3Xd x = nodes();
    for (Eigen::Index n = 0; n < x.cols(); ++n) {
      const Vector3d X = nodes().col(n);
      const double way = X.z() > 0.051 ? 0.05 : 0.07;
      x.col(n) += Vector3d(way * 0.1 * X.y() * X.z(), way * 0.2 * X.x() * X.x(),
                           -way * X.x() * X.x() + way * X.y() * X.y());
    }
    return x;
  }
};

TEST_CASE("each pair pushes two bodies with opposite forces and moments", "[solid][mutual]") {
  TwoBeams two(-0.002);
  two.pairs.use(two.pairs.detect(two.bent()));
  CHECK(two.pairs.evaluate(two.bent()) > 0.0);
  Matrix3Xd force = Matrix3Xd::Zero(3, two.model.mesh.node_count());
  two.pairs.add_forces(force);
  const double sum = force.colwise().norm().sum();
  REQUIRE(sum > 0.1);
  CHECK(force.rowwise().sum().norm() <= tolerance(1e-13, "rounding") * sum);
  const Matrix3Xd on = two.pairs.force_on_components();
  REQUIRE(on.cols() == 2);
  CHECK(on.rowwise().sum().norm() <= tolerance(1e-13, "rounding") * sum);
  CHECK(on(2, 0) < 0.0);  // the lower one is pushed down
  const int first = test::small_beam(8, 2, 2).mesh.node_count();
  CHECK((force.leftCols(first).rowwise().sum() - on.col(0)).norm() <= 1e-12 * sum);
  // Points of both skins have force, so that neither skin enters the other.
  std::array<int, 2> pressing{};
  for (const MutualPair& pair : two.pairs.pairs()) {
    if (pair.force > 0.0) ++pressing.at(pair.owner);
    CHECK(pair.owner != pair.component);
  }
  CHECK(pressing[0] > 10);
  CHECK(pressing[1] > 10);
}

TEST_CASE("forces between two bodies are the slope of their Lagrangian, and the tangent theirs",
          "[solid][mutual]") {
  TwoBeams two(-0.002);
  const Matrix3Xd x = two.bent();
  two.pairs.use(two.pairs.detect(x));
  two.pairs.evaluate(x);
  two.pairs.update_multipliers();  // not 0, so that both terms of energy and force are tested
  auto random = test::random_case(1);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  // Held nodes stay: the tangent is one in the free directions.
  Matrix3Xd way = Matrix3Xd::Zero(3, x.cols());
  for (const int n : two.assembly.free_nodes()) {
    way.col(n) = Vector3d(number(random), number(random), number(random));
  }
  const auto force_at = [&](double step) {
    Matrix3Xd force = Matrix3Xd::Zero(3, x.cols());
    two.pairs.evaluate(x + step * way);
    two.pairs.add_forces(force);
    return force;
  };
  const double h = 1e-7;
  const double slope =
      (two.pairs.evaluate(x + h * way) - two.pairs.evaluate(x - h * way)) / (2 * h);
  const Matrix3Xd force = force_at(0.0);
  CHECK(-force.cwiseProduct(way).sum() ==
        Approx(slope).epsilon(tolerance(1e-6, "differences over 1e-7 m; pairs that just touch")));

  VectorXd direction, product, change;
  two.assembly.gather(way, direction);
  two.assembly.gather(Matrix3Xd((force_at(-h) - force_at(h)) / (2 * h)), change);
  force_at(0.0);
  product.setZero(direction.size());
  two.pairs.add_product(direction, product);
  CHECK((product - change).norm() <=
        tolerance(1e-5, "differences; pairs that just touch") * change.norm());

  // The assembled tangent is the same if the pattern has the blocks between the two bodies, and
  // positive if it lacks them.
  CHECK_FALSE(two.pairs.fits(two.assembly.pattern()));
  const BlockPattern wide = two.pairs.widened(two.assembly.pattern());
  CHECK(two.pairs.fits(wide));
  BlockMatrix K(wide), narrow(two.assembly.pattern());
  two.pairs.add_tangent(K);
  VectorXd by_matrix;
  K.multiply(direction, by_matrix);
  CHECK((by_matrix - product).norm() <= tolerance(1e-12, "rounding") * product.norm());
  two.pairs.add_tangent(narrow);
  narrow.multiply(direction, by_matrix);
  CHECK(direction.dot(by_matrix) > 0.0);
}

TEST_CASE("friction between two bodies: opposite forces, the slope of a potential, its tangent",
          "[solid][mutual][friction]") {
  TwoBeams two(-0.002, 0.1, Vector3d::Zero(), {.coefficient = 0.3, .stiffness = 1.0});
  const Matrix3Xd x = two.bent();
  two.pairs.use(two.pairs.detect(x));
  two.pairs.begin_step(x);
  two.pairs.evaluate(x);
  two.pairs.update_friction(x);
  two.pairs.update_multipliers();
  // Their gaps were below 0 when the step began: they are anchored where they are.
  two.pairs.evaluate(x);
  for (const MutualPair& pair : two.pairs.pairs()) {
    CHECK(pair.friction.anchored == (pair.multiplier > 0.0));
    CHECK(pair.friction.slide.norm() <= tolerance(1e-14, "rounding, m"));
  }
  // The upper beam moves aside.
  const Vector3d aside(5e-4, 3.3e-4, 0);
  Matrix3Xd moved = x;
  const int first = test::small_beam(8, 2, 2).mesh.node_count();
  moved.rightCols(x.cols() - first).colwise() += aside;
  two.pairs.evaluate(moved);
  int slips = 0, sticks = 0;
  for (const MutualPair& pair : two.pairs.pairs()) {
    if (pair.friction.limit == 0.0) continue;
    ++(pair.friction.slips ? slips : sticks);
    // It pulls the upper beam back.
    const double along = pair.friction.force.dot(aside);
    CHECK((pair.owner == 1 ? along : -along) < 0.0);
  }
  CHECK(slips > 10);
  CHECK(sticks > 10);
  Matrix3Xd force = Matrix3Xd::Zero(3, x.cols());
  two.pairs.add_forces(force);
  const double sum = force.colwise().norm().sum();
  CHECK(force.rowwise().sum().norm() <= tolerance(1e-13, "rounding") * sum);
  const Matrix3Xd on = two.pairs.force_on_components();
  CHECK(on.rowwise().sum().norm() <= tolerance(1e-13, "rounding") * sum);
  CHECK((force.leftCols(first).rowwise().sum() - on.col(0)).norm() <= 1e-12 * sum);

  auto random = test::random_case(2);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  Matrix3Xd way = Matrix3Xd::Zero(3, x.cols());
  for (const int n : two.assembly.free_nodes()) {
    way.col(n) = Vector3d(number(random), number(random), number(random));
  }
  const double h = 1e-9;  // no pair changes between sticking and slipping
  const auto force_at = [&](double step, double& energy) {
    Matrix3Xd there = Matrix3Xd::Zero(3, x.cols());
    energy = two.pairs.evaluate(moved + step * way);
    two.pairs.add_forces(there);
    return there;
  };
  double low = 0.0, high = 0.0;
  const Matrix3Xd force_high = force_at(h, high), force_low = force_at(-h, low);
  CHECK(-force.cwiseProduct(way).sum() ==
        Approx((high - low) / (2 * h)).epsilon(tolerance(1e-5, "differences over 1e-9 m")));
  VectorXd direction, product, change;
  two.assembly.gather(way, direction);
  two.assembly.gather(Matrix3Xd((force_low - force_high) / (2 * h)), change);
  two.pairs.evaluate(moved);
  product.setZero(direction.size());
  two.pairs.add_product(direction, product);
  CHECK((product - change).norm() <= tolerance(1e-6, "differences over 1e-9 m") * change.norm());
  const BlockPattern wide = two.pairs.widened(two.assembly.pattern());
  CHECK(two.pairs.fits(wide));
  BlockMatrix K(wide), narrow(two.assembly.pattern());
  two.pairs.add_tangent(K);
  VectorXd by_matrix;
  K.multiply(direction, by_matrix);
  CHECK((by_matrix - product).norm() <= tolerance(1e-12, "rounding") * product.norm());
  two.pairs.add_tangent(narrow);
  narrow.multiply(direction, by_matrix);
  CHECK(direction.dot(by_matrix) > 0.0);

  // end_step() moves the anchors of pairs that slipped, by which their force is kept; the others
  // stay.
  std::vector<MutualPair> before = two.pairs.pairs();
  CHECK(two.pairs.end_step(moved) > 0.0);
  two.pairs.evaluate(moved);
  for (std::size_t i = 0; i < before.size(); ++i) {
    const MutualPair& now = two.pairs.pairs()[i];
    if (before[i].friction.slips) {
      const Vector3d kept = elastic_slip(before[i].friction);
      CHECK((now.friction.slide - kept).norm() <= tolerance(1e-12, "rounding, m"));
      CHECK((now.friction.force - before[i].friction.force).norm() <= 1e-9);
    } else if (before[i].friction.limit > 0.0) {
      CHECK(now.friction.slide == before[i].friction.slide);
    }
  }
}

TEST_CASE("the gap is the distance between the skins, and its slope along the normal",
          "[solid][mutual]") {
  TwoBeams two(0.004);
  const Matrix3Xd x = two.bent();
  auto detected = two.pairs.detect(x);
  REQUIRE(detected.pairs.size() > 50);
  double smallest = 1.0;
  int over = 0;
  for (const MutualPair& pair : detected.pairs) {
    Vector3d across = Vector3d::Zero();
    double weights = 0.0;
    for (int k = 0; k < pair.count; ++k) {
      across += pair.shape[k] * x.col(pair.nodes[k]);
      weights += pair.shape[k];
    }
    CHECK(std::abs(weights) <= tolerance(1e-14, "rounding"));
    CHECK(pair.gap == Approx(pair.normal.dot(across)).margin(1e-15));
    // Only over the middle of both beams: beside a rim the nearest point is not straight below.
    const Vector3d at = position_of(two.points.points[pair.point], two.nodes());
    if (at.x() > 0.05 && at.x() < 0.3 && at.y() > 0.045 && at.y() < 0.09) {
      ++over;
      CHECK(std::abs(pair.gap - across.norm()) <=
            tolerance(1e-3, "faces meet by 2 degrees") * across.norm());
    }
    smallest = std::min(smallest, pair.gap);
  }
  CHECK(over > 100);
  CHECK(detected.smallest_gap == smallest);
  two.pairs.use(std::move(detected));
  CHECK(two.pairs.evaluate(x) == 0.0);
  CHECK(two.pairs.detect(x).shift == 0.0);
}

TEST_CASE("what lies beside, behind or far off presses nothing", "[solid][mutual]") {
  // Beside the rim: the second's lower rim passes the first's side, 2 mm off it and 5 mm below its
  // top.
  TwoBeams beside(-0.005, 0.0, Vector3d(0, 0.102, 0));
  beside.pairs.use(beside.pairs.detect(beside.nodes()));
  beside.pairs.evaluate(beside.nodes());
  CHECK(beside.pairs.force_on_components().norm() == 0.0);
  // Behind: the second hangs under the first, so that its skin is behind the first's top.
  TwoBeams below(-0.11);
  below.pairs.use(below.pairs.detect(below.nodes()));
  CHECK_FALSE(below.pairs.pairs().empty());
  below.pairs.evaluate(below.nodes());
  CHECK(below.pairs.force_on_components().norm() == 0.0);
  TwoBeams far(0.04);
  CHECK(far.pairs.detect(far.nodes()).pairs.empty());
}

TEST_CASE("rims that coincide press along the faces, whatever rounding says", "[solid][mutual]") {
  for (const double off : {0.0, 1e-12, -1e-12}) {
    INFO(off);
    TwoBeams two(-0.001, 0.0, Vector3d(off, -off, 0));
    two.pairs.use(two.pairs.detect(two.nodes()));
    two.pairs.evaluate(two.nodes());
    int pressing = 0;
    for (const MutualPair& pair : two.pairs.pairs()) {
      if (pair.force == 0.0) continue;
      ++pressing;
      CHECK(pair.gap == Approx(-0.001).epsilon(1e-6));
      CHECK(std::abs(pair.normal.z()) == Approx(1.0).epsilon(1e-9));
    }
    // The contact points of the two faces that meet.
    int there = 0;
    for (const ContactPoint& point : two.points.points) {
      const double z = position_of(point, two.nodes()).z();
      if (std::abs(z - 0.05) < 1e-9 || std::abs(z - 0.049) < 1e-9) ++there;
    }
    CHECK(pressing >= there);
  }
}

TEST_CASE("curved skins are refused", "[solid][mutual][errors]") {
  SolidModel model = TwoBeams::placed(0.01, 0.0, Vector3d::Zero());
  model.mesh = with_edge_nodes(model.mesh);
  const Boundary boundary = boundary_of(model.mesh);
  const TetAssembly assembly(model);
  const ContactPoints points = contact_points(model.mesh, boundary, 0.05);
  const VectorXd penalties = VectorXd::Ones(model.mesh.node_count());
  CHECK_THROWS_WITH(MutualPairs(assembly, model.mesh, boundary, points, penalties, 0.03),
                    Catch::Matchers::Contains("10-node"));
}

}  // namespace
}  // namespace palpable
