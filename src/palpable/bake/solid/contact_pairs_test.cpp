// Friction of the pairs of a contact point and an obstacle: forces, tangent, anchors.
#include "palpable/bake/solid/contact_pairs.h"

#include "tests/support/small_beam.h"
#include "tests/support/test.h"

#include <Eigen/Geometry>

#include <cstddef>
#include <random>
#include <vector>

namespace palpable {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using test::tolerance;

constexpr double kBeamTop = 0.05, kLarge = 0.2;  // m; of the ball that presses it

// A small beam, and a large ball on its top, `deep` (m) inside and moved aside.
struct BallOnBeam {
  SolidModel model = test::small_beam(8, 4, 2);
  Boundary boundary = boundary_of(model.mesh);
  TetAssembly assembly{model};
  ContactPoints points = contact_points(model.mesh, boundary, 0.01);
  VectorXd penalties = VectorXd::Constant(static_cast<Eigen::Index>(points.points.size()), 2e4);
  ContactPairs pairs{assembly, boundary, points, penalties, {.coefficient = 0.3, .stiffness = 0.5}};

  [[nodiscard]] const Matrix3Xd& nodes() const { return model.mesh.nodes; }
  static Obstacle at(double deep, const Vector3d& aside = Vector3d::Zero()) {
    return {.capsules = {ball(Vector3d(0.2, 0.05, kBeamTop + kLarge - deep) + aside, kLarge)}};
  }
  // One step in which the beam stays where it is.
  void step(const Obstacle& before, const Obstacle& after) {
    const ObstacleGaps gaps(after);
    pairs.reassign_parts(gaps, before, nodes());
    pairs.begin_step(gaps, before, nodes());
    pairs.set_predicted(nodes());
    pairs.find(gaps, nodes(), 0.05);
    update(gaps);
    pairs.evaluate(gaps, nodes());
  }
  void update(const ObstacleGaps& gaps) {
    pairs.evaluate(gaps, nodes());
    pairs.update_friction(gaps, nodes());
    pairs.update_multipliers();
  }
};

TEST_CASE("points that begin to press within a step are anchored where the obstacle touched them",
          "[solid][contact][friction]") {
  BallOnBeam body;
  const Vector3d aside(2e-4, 1e-4, 0);
  body.step(BallOnBeam::at(-0.001), BallOnBeam::at(0.003, aside));
  int pressing = 0;
  for (const ContactPair& pair : body.pairs.pairs()) {
    CHECK(pair.friction.anchored == (pair.multiplier > 0.0));
    if (!pair.friction.anchored) continue;
    ++pressing;
    const Vector3d x = position_of(body.points.points[pair.point], body.nodes());
    const Vector3d outwards = x - (Vector3d(0.2, 0.05, kBeamTop + kLarge + 0.001));
    const double before = outwards.norm() - kLarge;  // the gap when the step began
    const double share = before / (before - pair.gap.distance);
    const Vector3d anchor = x + (1.0 - share) * (aside - Vector3d(0, 0, 0.004));
    CHECK((pair.anchor - anchor).norm() <= tolerance(1e-12, "rounding, m"));
  }
  CHECK(pressing > 20);
}

TEST_CASE("an anchor moves with its part, also where other parts appear, until its point leaves",
          "[solid][contact][friction]") {
  BallOnBeam body;
  Obstacle before = BallOnBeam::at(0.001), after = BallOnBeam::at(0.002);
  body.step(before, after);
  body.pairs.end_step(body.nodes());
  const std::vector<ContactPair> pressed = body.pairs.pairs();
  // The ball moves aside, and has the number 1 from now on.
  const Vector3d aside(1e-5, -2e-5, 0);
  before = after;
  after = BallOnBeam::at(0.002, aside);
  after.capsules.insert(after.capsules.begin(), ball({0.2, 0.05, 0.9}, 0.3));
  body.step(before, after);
  int pressing = 0;
  for (const ContactPair& old : pressed) {
    if (!old.friction.anchored) continue;
    for (const ContactPair& pair : body.pairs.pairs()) {
      if (pair.point != old.point || pair.multiplier == 0.0) continue;
      ++pressing;
      CHECK(pair.part == 1);
      CHECK(pair.friction.anchored);
      CHECK((pair.anchor - old.anchor - aside).norm() <= tolerance(1e-14, "rounding, m"));
    }
  }
  CHECK(pressing > 20);
  body.pairs.end_step(body.nodes());
  // It leaves.
  before = after;
  after = BallOnBeam::at(-0.01);
  after.capsules.insert(after.capsules.begin(), ball({0.2, 0.05, 0.9}, 0.3));
  body.step(before, after);
  body.pairs.end_step(body.nodes());
  for (const ContactPair& pair : body.pairs.pairs()) { CHECK_FALSE(pair.friction.anchored); }
}

TEST_CASE("a part keeps its points where as many others come as go", "[solid][contact]") {
  BallOnBeam body;
  Obstacle before = BallOnBeam::at(0.002), after = before;
  before.half_spaces.push_back({{0, 0, 1}, {0, 0, -1}});
  // Another ball appears before it in the list, and the half space is gone. There are two parts as
  // before, but the ball that presses has the number 1 now, which was that of the half space.
  after.capsules.insert(after.capsules.begin(), ball({0.2, 0.05, 0.9}, 0.3));
  body.step(before, before);
  body.step(before, after);
  int pressing = 0;
  for (const ContactPair& pair : body.pairs.pairs()) {
    if (pair.multiplier == 0.0) continue;
    CHECK(pair.part == 1);
    ++pressing;
  }
  CHECK(pressing > 20);
}

TEST_CASE("friction of a ball is the slope of a potential, and the tangent its derivative",
          "[solid][contact][friction]") {
  BallOnBeam body;
  const Obstacle before = BallOnBeam::at(0.002), after = BallOnBeam::at(0.002, {5e-4, 7.5e-4, 0});
  body.step(before, before);
  body.pairs.end_step(body.nodes());
  body.step(before, after);
  const ObstacleGaps gaps(after);
  int slips = 0, sticks = 0;
  for (const ContactPair& pair : body.pairs.pairs()) {
    if (pair.friction.limit == 0.0) continue;
    ++(pair.friction.slips ? slips : sticks);
    CHECK(pair.friction.force.dot(Vector3d(5e-4, 7.5e-4, 0)) > 0.0);  // it drags the skin along
  }
  CHECK(slips > 5);
  CHECK(sticks > 5);

  auto random = test::random_case(1);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  Matrix3Xd way = Matrix3Xd::Zero(3, body.nodes().cols());
  for (const int n : body.assembly.free_nodes()) {
    way.col(n) = Vector3d(number(random), number(random), number(random));
  }
  const double h = 1e-8;
  const auto force_at = [&](double step, double& energy) {
    Matrix3Xd force = Matrix3Xd::Zero(3, way.cols());
    energy = body.pairs.evaluate(gaps, body.nodes() + step * way);
    body.pairs.add_forces(force);
    return force;
  };
  double low = 0.0, high = 0.0, middle = 0.0;
  const Matrix3Xd force_high = force_at(h, high), force_low = force_at(-h, low);
  const Matrix3Xd force = force_at(0.0, middle);
  CHECK(-force.cwiseProduct(way).sum() ==
        Approx((high - low) / (2 * h)).epsilon(tolerance(1e-5, "differences over 1e-8 m")));
  VectorXd direction, product, change, by_matrix;
  body.assembly.gather(way, direction);
  body.assembly.gather(Matrix3Xd((force_low - force_high) / (2 * h)), change);
  product.setZero(direction.size());
  body.pairs.add_product(direction, true, product);
  CHECK((product - change).norm() <=
        tolerance(1e-4, "differences; points that just touch or slip") * change.norm());
  // The assembled tangent leaves the obstacle's curvature out.
  product.setZero();
  body.pairs.add_product(direction, false, product);
  BlockMatrix K(body.assembly.pattern());
  body.pairs.add_tangent(K);
  K.multiply(direction, by_matrix);
  CHECK((by_matrix - product).norm() <= tolerance(1e-12, "rounding") * product.norm());
  CHECK(direction.dot(product) > 0.0);

  // What slips dissipates, and is then anchored where it is.
  const std::vector<ContactPair> last = body.pairs.pairs();
  CHECK(body.pairs.end_step(body.nodes()) > 0.0);
  for (std::size_t i = 0; i < last.size(); ++i) {
    const ContactPair& pair = body.pairs.pairs()[i];
    if (last[i].multiplier == 0.0) continue;
    const Vector3d x = position_of(body.points.points[pair.point], body.nodes());
    CHECK((pair.anchor == x - elastic_slip(last[i].friction)) == last[i].friction.slips);
  }
}

}  // namespace
}  // namespace palpable
