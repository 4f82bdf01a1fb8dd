#include "palpable/bake/touch_bake/touch_difference.h"

#include "palpable/bake/solid/stress.h"
#include "palpable/bake/touch_bake/full_solution.h"

#include <algorithm>
#include <chrono>
#include <vector>

namespace palpable {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

constexpr double kFrame = 1.25e-3;  // m, how far the obstacle advances in a frame
// Steps of the full solver in a frame with friction, whose solution depends on the path
// (solid/contact.h): 0.31 mm.
constexpr int kRubbingSteps = 4;

double milliseconds_since(std::chrono::steady_clock::time_point begin) {
  return 1e3 * std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

// |F_a - F_b| / |F_b|, F_b the true force. F is the resultant; for a squeeze, where the forces of
// the two obstacles cancel, F is the sum of the norms of all forces.
double force_difference(const TouchState& state, const Matrix3Xd& truth, bool squeeze) {
  Vector3d sum = Vector3d::Zero();
  double norms = 0;
  for (const PointForce& force : state.forces) {
    sum += force.force.cast<double>();
    norms += static_cast<double>(force.force.norm());
  }
  const double true_norms = truth.colwise().norm().sum();
  if (squeeze) return std::abs(norms - true_norms) / true_norms;
  const Vector3d true_sum = truth.rowwise().sum();
  return (sum - true_sum).norm() / true_sum.norm();
}

// Bounding boxes of the capsules, which are the first parts of the obstacle; other parts have none.
std::vector<Eigen::AlignedBox3f> boxes_of(const ObstacleGaps& gaps) {
  std::vector<Eigen::AlignedBox3f> boxes;
  for (const Capsule& capsule : gaps.obstacle().capsules) {
    boxes.push_back(box_of(capsule).cast<float>());
  }
  return boxes;
}

// Whether a part has a box and the box is at least `reach` (m) away from a position.
bool is_farther(const std::vector<Eigen::AlignedBox3f>& boxes, int part,
                const Eigen::Vector3f& place, float reach) {
  const auto box = static_cast<std::size_t>(part);
  return box < boxes.size() && reach > 0 &&
         !(boxes[box].squaredExteriorDistance(place) < reach * reach);
}

// Compares the present states of the tables (`touch`, `state`) and of the full solver (`walk`).
TouchDifference difference_of(const SkinResponse& skin, const ContactWalk& walk, TouchSolver& touch,
                              const TouchState& state, const TouchScene& scene, double depth) {
  const Matrix3Xd u = true_displacement(skin, walk.now().displacement);
  TouchDifference d;
  d.displacement = state.u.leftCols(u.cols());
  d.true_displacement = u.cast<float>();
  d.von_mises.resize(u.cols());
  const auto begin = std::chrono::steady_clock::now();
  touch.stress(state, std::span(d.von_mises.data(), static_cast<std::size_t>(u.cols())));
  d.stress_milliseconds = milliseconds_since(begin);
  const Eigen::VectorXd stress = true_von_mises(skin, walk.now().displacement);
  d.true_von_mises = stress.cast<float>();
  const Matrix3Xd difference = d.displacement.cast<double>() - u;
  d.worst_vertex = difference.colwise().norm().maxCoeff();
  d.touch = {
      .thing = scene.thing,
      .depth = depth,
      .displacement = difference.norm() / u.norm(),
      .force = force_difference(state, walk.nodal_forces(), scene.thing == PressingThing::kSqueeze),
      .von_mises = (d.von_mises.cast<double>() - stress).cwiseAbs().maxCoeff() / stress.maxCoeff()};
  return d;
}

// The full-order solution of a scene, on request also one with half the steps.
class FullWalks {
 public:
  FullWalks(const EquilibriumSolver& solver, const SkinResponse& skin, const Preloaded* preloaded,
            const ObstacleMotion& motion, double point_spacing, const ComparisonSettings& settings)
      : skin_(&skin), steps_(settings.friction > 0 ? kRubbingSteps : 1) {
    ContactSettings contact;
    contact.spacing = point_spacing;
    contact.friction = settings.friction;
    walk_.emplace(solver, motion, -1e-4, contact, preloaded);
    if (settings.halves_steps) finer_.emplace(solver, motion, -1e-4, contact, preloaded);
  }

  // Advances both by one frame. Returns why one of them stopped; empty if none did.
  [[nodiscard]] std::string advance(double from, double to) {
    if (!advance_in(*walk_, from, to, steps_)) return walk_->why_stopped();
    // Nothing yields there, and no live touch counts as an answer.
    if (walk_->now().held_entry > kHeldMatters)
      return "the obstacle presses skin that the support holds";
    if (finer_ && !advance_in(*finer_, from, to, 2 * steps_)) {
      return "with half the steps " + finer_->why_stopped();
    }
    return {};
  }

  [[nodiscard]] const ContactWalk& now() const { return *walk_; }
  [[nodiscard]] std::optional<double> half_step() const {
    if (!finer_) return std::nullopt;
    const Matrix3Xd a = true_displacement(*skin_, walk_->now().displacement);
    const Matrix3Xd b = true_displacement(*skin_, finer_->now().displacement);
    const double larger = std::max(a.norm(), b.norm());
    return larger > 0 ? (a - b).norm() / larger : 0.0;
  }

 private:
  [[nodiscard]] static bool advance_in(ContactWalk& walk, double from, double to, int steps) {
    for (int k = 1; k < steps; ++k) {
      if (!walk.pass(from + (to - from) * k / steps)) return false;
    }
    return walk.advance(to);
  }

  const SkinResponse* skin_;
  int steps_;  // of a frame
  std::optional<ContactWalk> walk_, finer_;
};

}  // namespace

Matrix3Xd true_displacement(const SkinResponse& skin, const Matrix3Xd& displacement) {
  const Matrix3Xd moved = displacement - skin.body().rest();
  return skin.on_skin(moved.reshaped()).reshaped(3, skin.vertex_count());
}

Eigen::VectorXd true_von_mises(const SkinResponse& skin, const Matrix3Xd& displacement) {
  const Eigen::VectorXd nodal =
      von_mises(nodal_cauchy_stress(skin.body().model(), displacement, skin.recovery()));
  return nodal(std::span(skin.shell_nodes()).first(static_cast<std::size_t>(skin.vertex_count())));
}

ExactObstacles::ExactObstacles(const ObstacleGaps& gaps, const Obstacle* before)
    : gaps_(&gaps),
      before_(before),
      boxes_(boxes_of(gaps)),
      is_boxed_(gaps.part_count() == std::ssize(boxes_)) {
  for (const Eigen::AlignedBox3f& box : boxes_) all_.extend(box);
}

void ExactObstacles::find_gaps(std::span<const Eigen::Vector3f> places,
                               std::span<SurfaceGap> gaps) const {
  for (std::size_t k = 0; k < places.size(); ++k) {
    const Vector3d x = places[k].cast<double>();
    double nearest = static_cast<double>(kGapReach);
    int part = -1;
    for (int p = 0; p < gaps_->part_count(); ++p) {
      if (is_farther(boxes_, p, places[k], static_cast<float>(nearest))) continue;
      const double distance = gaps_->distance(p, x);
      if (distance >= nearest) continue;
      nearest = distance;
      part = p;
    }
    gaps[k] = {};
    if (part < 0) continue;
    const Gap found = gaps_->gap(part, x);
    gaps[k].distance = static_cast<float>(found.distance);
    gaps[k].normal = found.normal.cast<float>();
    gaps[k].curvature = found.curvature.cast<float>();
    if (before_ == nullptr) continue;
    gaps[k].part = part;
    gaps[k].friction = kFrictionOfBody;
  }
}

std::optional<MaterialPoint> ExactObstacles::carried(const MaterialPoint& before) const {
  if (before_ == nullptr || before.part < 0 || before.part >= gaps_->part_count()) {
    return std::nullopt;
  }
  const Vector3d now =
      palpable::carried(*before_, gaps_->obstacle(), before.part, before.place.cast<double>());
  return MaterialPoint{before.part, now.cast<float>()};
}

std::optional<Eigen::Vector3f> ExactObstacles::way_of(const MaterialPoint& now) const {
  if (before_ == nullptr || now.part < 0 || now.part >= gaps_->part_count()) return std::nullopt;
  const Vector3d place = now.place.cast<double>();
  const Vector3d way = place - palpable::carried(gaps_->obstacle(), *before_, now.part, place);
  return Eigen::Vector3f(way.cast<float>());
}

struct ExactObstacles::OnTheWay {
  ObstacleGaps gaps;
  ExactObstacles obstacles;
  OnTheWay(const Obstacle& before, const Obstacle& now, double done)
      : gaps(interpolated(before, now, done)), obstacles(gaps, &before) {}
};

const Obstacles* ExactObstacles::on_the_way(float done) const {
  if (before_ == nullptr) return nullptr;
  on_the_way_ =
      std::make_shared<const OnTheWay>(*before_, gaps_->obstacle(), static_cast<double>(done));
  return &on_the_way_->obstacles;
}

bool ExactObstacles::may_be_within(const Eigen::Vector3f& place, float reach) const {
  if (is_boxed_ && !(all_.squaredExteriorDistance(place) < reach * reach)) return false;
  for (int p = 0; p < gaps_->part_count(); ++p) {
    if (is_farther(boxes_, p, place, reach)) continue;
    if (gaps_->distance(p, place.cast<double>()) < static_cast<double>(reach)) return true;
  }
  return false;
}

std::string compare_touch(const EquilibriumSolver& solver, const SkinResponse& skin,
                          const Preloaded* preloaded, TouchSolver& touch, double point_spacing,
                          const TouchScene& scene, std::span<const double> depths,
                          const std::function<void(const TouchDifference&)>& found,
                          const ComparisonSettings& settings) {
  FullWalks walks(
      solver, skin, preloaded, [&scene](double depth) { return obstacle_at(scene, depth); },
      point_spacing, settings);
  TouchState state;
  double depth = 0;
  for (const double last : depths) {
    TouchReport report;
    double took = 0;
    while (depth < last) {
      // The last frame ends at the depth that is compared; it takes up to 10 % more instead of
      // leaving a very short frame.
      const double begun = depth;
      const Obstacle before = obstacle_at(scene, begun);
      depth = last - depth < 1.1 * kFrame ? last : depth + kFrame;
      if (std::string why = walks.advance(begun, depth); !why.empty()) return why;
      const ObstacleGaps gaps(obstacle_at(scene, depth));
      const auto begin = std::chrono::steady_clock::now();
      report = touch.advance(state, ExactObstacles(gaps, &before));
      took = milliseconds_since(begin);
    }
    const auto report_difference = [&](const TouchState& now, int refined) {
      TouchDifference d = difference_of(skin, walks.now(), touch, now, scene, depth);
      d.half_step = walks.half_step();
      d.refined = refined;
      d.report = report;
      d.touch.unscaled_error = unscaled_error(report.indicators);
      d.milliseconds = took;
      found(d);
    };
    report_difference(state, 0);
    TouchState rests = settings.refinements > 0 ? state : TouchState();
    const Obstacle at_rest = obstacle_at(scene, depth);
    const ObstacleGaps gaps(at_rest);
    for (int k = 1; k <= settings.refinements; ++k) {
      RequestedLoad requested;
      if (touch.request(rests, requested)) {
        const auto full = full_solution(solver, skin, preloaded, requested.forces);
        if (full) (void)touch.refine(rests, requested, *full);
      }
      do report = touch.advance(rests, ExactObstacles(gaps, &at_rest));
      while (rests.refinement.blended < 1);
      report_difference(rests, k);
    }
  }
  return {};
}

std::string compare_drag(const EquilibriumSolver& solver, const SkinResponse& skin,
                         const Preloaded* preloaded, TouchSolver& touch, double point_spacing,
                         const TouchScene& scene, double depth, std::span<const double> drags,
                         const std::function<void(const TouchDifference&)>& found,
                         const ComparisonSettings& settings) {
  // The obstacle after a path of t: down, then aside.
  const auto after = [&](double t) {
    Rigid3 aside = Rigid3::Identity();
    aside.translation() = std::max(0.0, t - depth) * scene.way.unitOrthogonal();
    return moved(obstacle_at(scene, std::min(t, depth)), aside);
  };
  FullWalks walks(solver, skin, preloaded, after, point_spacing, settings);
  TouchState state;
  double t = 0;
  for (const double drag : drags) {
    TouchReport report;
    double took = 0;
    while (t < depth + drag) {
      // Frames end where the press ends, and where the state is compared.
      const double last = t < depth ? depth : depth + drag, begun = t;
      const Obstacle before = after(t);
      t = last - t < 1.1 * kFrame ? last : t + kFrame;
      if (std::string why = walks.advance(begun, t); !why.empty()) return why;
      const ObstacleGaps gaps(after(t));
      const auto begin = std::chrono::steady_clock::now();
      report = touch.advance(state, ExactObstacles(gaps, &before));
      took = milliseconds_since(begin);
    }
    if (walks.now().now().touching == 0) return {};  // dragged off the body
    TouchDifference d = difference_of(skin, walks.now(), touch, state, scene, depth);
    d.dragged = drag;
    d.report = report;
    d.touch.unscaled_error = unscaled_error(report.indicators);
    d.milliseconds = took;
    found(d);
  }
  return {};
}

}  // namespace palpable
