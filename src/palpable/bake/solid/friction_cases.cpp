#include "palpable/bake/solid/friction_cases.h"

#include "palpable/bake/solid/contact.h"
#include "palpable/bake/solid/selection.h"
#include "palpable/common/base/error.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

namespace palpable {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

namespace {

void go_to(ContactWalk& walk, double t, const char* problem) {
  if (!walk.advance(t)) throw Error(std::string(problem) + ": " + walk.why_stopped());
}

// ---- Cattaneo and Mindlin

constexpr double kMindlinYoung = 1e5, kMindlinPoisson = 0.1, kMindlinFriction = 0.1;  // Pa
constexpr double kMindlinContact = 0.02, kMindlinBall = 1.0;  // a, R, m: strains stay below 1 %
constexpr double kMindlinDepth = kMindlinContact * kMindlinContact / kMindlinBall;
// d_0 by the closed form for a rigid ball, m.
constexpr double kMindlinSlide =
    kMindlinFriction * (2.0 - kMindlinPoisson) / (2.0 * (1.0 - kMindlinPoisson)) * kMindlinDepth;
// Share of d_0 by which the ball is dragged: Q reaches some 0.9 mu P.
constexpr double kMindlinShare = 0.8;
constexpr double kMindlinEdge = 6.0;   // over a: the least edge of the block
constexpr double kMindlinEven = 1.25;  // over a: how far the cells under the ball are even
constexpr double kMindlinGrowth = 1.26;

// Ends of the cells along an edge, m: even to `even` a, then growing.
std::vector<double> mindlin_places(int cells_in_radius, double even) {
  double cell = kMindlinContact / cells_in_radius;
  std::vector<double> places{0.0};
  while (places.back() < kMindlinEdge * kMindlinContact) {
    if (places.back() > even * kMindlinContact) cell *= kMindlinGrowth;
    places.push_back(places.back() + cell);
  }
  return places;
}

// Half a block: y = 0 is its plane of symmetry, z points into it.
SolidModel mindlin_block(int cells_in_radius) {
  const std::vector<double> across = mindlin_places(cells_in_radius, kMindlinEven);
  const std::vector<double> down = mindlin_places(cells_in_radius, 0.0);
  const int wide = static_cast<int>(across.size()) - 1, deep = static_cast<int>(down.size()) - 1;
  SolidModel model;
  model.mesh = box_tets({-wide, 0, 0}, {wide, wide, deep}, 2 * wide, wide, deep);
  const auto place = [](const std::vector<double>& places, double cell) {
    return std::copysign(places[static_cast<std::size_t>(std::lround(std::abs(cell)))], cell);
  };
  model.material = material_from_young("neo-hookean", kMindlinYoung, kMindlinPoisson);
  for (int n = 0; n < model.mesh.node_count(); ++n) {
    const Vector3d cell = model.mesh.nodes.col(n);
    model.mesh.nodes.col(n) << place(across, cell.x()), place(across, cell.y()),
        place(down, cell.z());
    const auto is = [](double one, int other) { return std::lround(std::abs(one)) == other; };
    if (is(cell.x(), wide) || is(cell.y(), wide) || is(cell.z(), deep)) {
      model.fixed_nodes.push_back(n);
    } else if (is(cell.y(), 0)) {
      model.supports.push_back({.node = n, .held = {false, true, false}});
    }
  }
  return model;
}

// Down until t = 1, aside until t = 2, and back beyond the middle until t = 4.
Obstacle mindlin_ball(double t) {
  const double down = std::min(t, 1.0) * kMindlinDepth;
  const double aside = t < 2.0 ? std::max(0.0, t - 1.0) : 3.0 - t;
  return {.capsules = {
              ball({aside * kMindlinShare * kMindlinSlide, 0, down - kMindlinBall}, kMindlinBall)}};
}

// The ball is pressed without friction, and then has it.
ContactWalk press_mindlin(const EquilibriumSolver& solver, int cells_in_radius, double coefficient,
                          double stiffer = 1.0) {
  // Longer than the diagonal of a cell: the corners are the only contact points, and each has one
  // force that fits.
  const double spacing = 1.5 * kMindlinContact / cells_in_radius;
  ContactSettings settings{.largest_entry = 1e-7, .spacing = spacing};
  settings.sticking_penalty *= stiffer;
  ContactWalk walk(solver, mindlin_ball, 0.0, settings);
  for (const double t : {0.25, 0.5, 0.75, 1.0}) go_to(walk, t, "Mindlin's block");
  walk.set_friction(coefficient);
  return walk;
}

// Compliance of a contact that sticks all over, m/N, of the half block.
// @param stiffer  factor on ContactSettings::sticking_penalty
double mindlin_compliance(const EquilibriumSolver& solver, int cells_in_radius,
                          double stiffer = 1.0) {
  ContactWalk walk = press_mindlin(solver, cells_in_radius, 20.0, stiffer);
  const double before = walk.now().force.x();
  constexpr double kPart = 0.1;  // of the way
  go_to(walk, 1.0 + kPart, "Mindlin's block");
  return kPart * kMindlinShare * kMindlinSlide / (walk.now().force.x() - before);
}

double power_two_thirds(double x) { return std::pow(std::max(0.0, x), 2.0 / 3.0); }

}  // namespace

MindlinResult drag_mindlin_block(int cells_in_radius) {
  const EquilibriumSolver solver(mindlin_block(cells_in_radius), {.tolerance = 1e-10});
  const double compliance = mindlin_compliance(solver, cells_in_radius);
  ContactWalk walk = press_mindlin(solver, cells_in_radius, kMindlinFriction);
  const double pressed = walk.now().force.x();  // not 0, because the mesh is not symmetric
  MindlinResult result{.nodes = solver.model().mesh.node_count()};
  constexpr double kShear = kMindlinYoung / (2.0 * (1.0 + kMindlinPoisson));
  result.compliance_error =
      compliance / ((2.0 - kMindlinPoisson) / (4.0 * kShear * kMindlinContact)) - 1.0;
  result.elastic_slip = 1.0 - mindlin_compliance(solver, cells_in_radius, 10.0) / compliance;
  const auto step_to = [&](double t) {
    go_to(walk, t, "Mindlin's block");
    result.cone_error = std::max(result.cone_error, walk.now().cone_error);
  };
  const auto most_slide = [&] {
    return 1.5 * kMindlinFriction * walk.now().force.z() * compliance;
  };
  const auto ratio = [&] {
    return (walk.now().force.x() - pressed) / (kMindlinFriction * walk.now().force.z());
  };

  constexpr int kForth = 8, kBack = 12;
  double squares = 0.0;
  for (int k = 1; k <= kForth; ++k) {
    const double share = static_cast<double>(k) / kForth;
    step_to(1.0 + share);
    const double q = ratio(), slide = share * kMindlinShare * kMindlinSlide;
    const double stick = std::sqrt(walk.now().sticking_area / walk.now().touching_area);
    const double stick_off = stick / std::cbrt(std::max(1e-9, 1.0 - q)) - 1.0;
    squares += stick_off * stick_off / kForth;
    const double slide_off = slide / (most_slide() * (1.0 - power_two_thirds(1.0 - q))) - 1.0;
    result.displacement_error = std::max(result.displacement_error, std::abs(slide_off));
  }
  result.stick_radius_error = std::sqrt(squares);
  const double turn = ratio(), at_turn = kMindlinShare * kMindlinSlide;
  for (int k = 1; k <= kBack; ++k) {
    const double t = 2.0 + 2.0 * k / kBack;
    step_to(t);
    const double back =
        2.0 * power_two_thirds(1.0 - 0.5 * (turn - ratio())) - power_two_thirds(1.0 - turn) - 1.0;
    const double slide_off = (3.0 - t) * at_turn - most_slide() * back;
    result.unloading_error = std::max(result.unloading_error, std::abs(slide_off) / at_turn);
  }
  return result;
}

// ---- a block, and what presses it

namespace {

// A cube of 0.1 m and 20 kPa, held at its base.
SolidModel soft_cube(int cells, double poisson) {
  SolidModel model;
  model.mesh = box_tets({0, 0, 0}, {0.1, 0.1, 0.1}, cells, cells, cells);
  model.material = material_from_young("neo-hookean", 20e3, poisson);
  model.fixed_nodes = nodes_on_plane(model.mesh, {0, 0, 0}, {0, 0, 1}, 1e-9);
  return model;
}

constexpr double kPlateDown = 4e-3, kPlateAside = 8e-3;  // m

// A plate that comes down until t = 1 and is pulled aside until t = 2.
Obstacle plate_at(double t) {
  return {.half_spaces = {
              {{kPlateAside * std::max(0.0, t - 1.0), 0, 0.1 - kPlateDown * std::min(t, 1.0)},
               {0, 0, -1}}}};
}

// A ball that goes down by 5 mm until t = 5e-3 and then aside, m.
Obstacle dragged_ball(double t) {
  const double down = std::min(t, 5e-3), aside = std::max(0.0, t - 5e-3);
  return {.capsules = {ball({0.046 + aside, 0.048, 0.12 - down}, 0.02)}};
}

}  // namespace

SlipResult pull_plate(int cells, double coefficient, int steps) {
  // With a small Poisson's ratio points slide aside only little when the plate comes down.
  const EquilibriumSolver solver(soft_cube(cells, 0.05));
  ContactWalk walk(solver, plate_at, -0.1, {.friction = coefficient});
  for (const double t : {0.25, 0.5, 0.75, 1.0}) go_to(walk, t, "the plate");
  SlipResult result;
  result.least_sliding = std::numeric_limits<double>::infinity();
  ContactState before = walk.now();
  const double at_first = before.energy + before.dissipated;
  double work = 0.0, ratio = 0.0, least = std::numeric_limits<double>::infinity();
  for (int k = 1; k <= steps; ++k) {
    go_to(walk, 1.0 + static_cast<double>(k) / steps, "the plate");
    const ContactState& now = walk.now();
    const double of_step = 0.5 * (now.force.x() + before.force.x()) * kPlateAside / steps;
    work += of_step;
    least = std::min(least, of_step - (now.energy - before.energy));
    ratio = -now.force.x() / now.force.z();
    result.largest_ratio = std::max(result.largest_ratio, ratio / coefficient);
    if (now.sticking == 0) {
      result.least_sliding = std::min(result.least_sliding, ratio / coefficient);
    }
    before = now;
  }
  result.angle_error = std::atan(ratio) / std::atan(coefficient) - 1.0;
  result.least_lost = least / work;
  result.energy_error = work / (before.energy + before.dissipated - at_first) - 1.0;
  return result;
}

double creep_at_rest(int cells, double coefficient, int frames) {
  const EquilibriumSolver solver(soft_cube(cells, 0.3));
  const double last = 6e-3;
  const auto way = [last](double t) { return dragged_ball(std::min(t, last)); };
  ContactWalk walk(solver, way, -1e-3, {.friction = coefficient});
  for (int k = 1; k <= 6; ++k) go_to(walk, last * k / 6, "the ball");
  const Matrix3Xd begin = walk.now().displacement;
  double largest = 0.0;
  for (int k = 1; k <= frames; ++k) {
    go_to(walk, last + k, "the ball at rest");
    largest = std::max(largest, (walk.now().displacement - begin).colwise().norm().maxCoeff());
  }
  return largest;
}

double change_with_half_step(int cells, double coefficient, double step) {
  const EquilibriumSolver solver(soft_cube(cells, 0.3));
  const auto end_state = [&](int steps) -> Matrix3Xd {
    ContactWalk walk(solver, dragged_ball, -1e-4, {.friction = coefficient});
    for (int k = 1; k <= steps; ++k) go_to(walk, 0.01 * k / steps, "the dragged ball");
    return walk.now().displacement;
  };
  const int steps = static_cast<int>(std::ceil(0.01 / step - 1e-9));
  const Matrix3Xd fine = end_state(2 * steps);
  return (end_state(steps) - fine).norm() / fine.norm();
}

// ---- a strip round a cylinder

namespace {

constexpr double kStripHalf = 0.1, kStripWide = 4e-3, kStripThick = 4e-3;  // m
constexpr double kDrum = 0.04;                                             // m, r
constexpr double kDrumDown = 0.05, kDrumAside = 0.016;                     // m

// 10-node tetrahedra, because a strip of 4-node ones would be far too stiff in bending.
SolidModel strip(int cells) {
  SolidModel model;
  model.mesh = with_edge_nodes(
      box_tets({-kStripHalf, 0, 0}, {kStripHalf, kStripWide, kStripThick}, cells, 1, 1));
  model.material = material_from_young("neo-hookean", 1e6, 0.3);
  for (int n = 0; n < model.mesh.node_count(); ++n) {
    if (std::abs(model.mesh.nodes(0, n)) > kStripHalf - 1e-9) {
      model.fixed_nodes.push_back(n);
    } else {
      model.supports.push_back({.node = n, .held = {false, true, false}});
    }
  }
  return model;
}

// A cylinder across the strip that comes down until t = 1 and moves along the strip until t = 2.
Obstacle drum_at(double t) {
  const double x = kDrumAside * std::max(0.0, t - 1.0);
  const double z = kStripThick + kDrum - kDrumDown * std::min(t, 1.0);
  return {.capsules = {{{x, -0.1, z}, {x, 0.1, z}, kDrum, kDrum}}};
}

}  // namespace

CapstanResult slide_strip(int cells, double coefficient) {
  const EquilibriumSolver solver(strip(cells));
  // A soft penalty: steps push the strip by more than its thickness.
  ContactWalk walk(solver, drum_at, -0.01,
                   {.penalty = 5, .friction = coefficient, .sticking_penalty = 10});
  constexpr int kPressing = 50, kDragging = 32;
  for (int k = 1; k <= kPressing; ++k) {
    go_to(walk, static_cast<double>(k) / kPressing, "the strip, pressed");
  }
  for (int k = 1; k <= kDragging; ++k) {
    go_to(walk, 1.0 + static_cast<double>(k) / kDragging, "the strip, dragged");
  }
  // The forces at the two ends.
  const Matrix3Xd forces = solver.internal_force(walk.now().displacement);
  const Matrix3Xd& X = solver.model().mesh.nodes;
  Vector3d left = Vector3d::Zero(), right = Vector3d::Zero();
  for (const int n : solver.model().fixed_nodes) (X(0, n) < 0.0 ? left : right) += forces.col(n);
  left.y() = right.y() = 0.0;
  CapstanResult result;
  result.ratio = left.norm() / right.norm();
  result.angle = std::numbers::pi - std::atan2(left.cross(right).norm(), left.dot(right));
  result.error =
      result.ratio / std::exp(coefficient * result.angle * kDrum / (kDrum + 0.5 * kStripThick)) -
      1.0;
  result.sticking = walk.now().sticking;
  return result;
}

}  // namespace palpable
