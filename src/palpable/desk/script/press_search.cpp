#include "palpable/desk/script/press_search.h"

#include "palpable/common/geometry/rigid.h"
#include "palpable/desk/script/contact_truth.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace palpable {

namespace {

using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kDeskGap = 0.003;    // m, smallest gap between hand and desk
constexpr double kFree = 0.012;       // m, clearance beyond which more does not raise the score
constexpr double kFreeWeight = 60.0;  // weight of the clearance in a hold's score, 1/m

Eigen::Matrix3Xd every_nth(const Eigen::Matrix3Xd& points, Eigen::Index wanted) {
  const Eigen::Index step = std::max<Eigen::Index>(1, points.cols() / wanted);
  Eigen::Matrix3Xd some(3, (points.cols() + step - 1) / step);
  for (Eigen::Index i = 0; i < some.cols(); ++i) some.col(i) = points.col(i * step);
  return some;
}

/// An orientation of the hand. `liking` is higher the more natural it is.
struct HandHold {
  Vector3d pointing, back;
  double liking;
};

std::vector<HandHold> holds_of_finger(const Vector3d& d) {
  std::vector<HandHold> holds;
  const Vector3d flat = Vector3d(d.x(), d.y(), 0.0).normalized();
  for (const double yaw : {0.0, -20.0, 20.0, -40.0, 40.0})
    for (const double down : {5.0, 20.0, 35.0, 50.0, 65.0})
      for (const double roll : {0.0, -25.0, 25.0, -50.0, 50.0, 75.0}) {
        const Vector3d level = AngleAxisd(yaw * kDegree, Vector3d::UnitZ()) * flat;
        const Vector3d f =
            std::cos(down * kDegree) * level - std::sin(down * kDegree) * Vector3d::UnitZ();
        if (f.dot(d) < std::cos(62.0 * kDegree)) continue;
        holds.push_back({f, AngleAxisd(roll * kDegree, f) * Vector3d::UnitZ(),
                         0.8 * f.dot(d) - 0.004 * std::abs(roll) - 0.3 * std::abs(level.y()) -
                             0.4 * level.x()});
      }
  return holds;
}

/// Orientations of a palm that is pushed along d: the fingers are perpendicular to d and point in
/// any of 24 directions.
std::vector<HandHold> holds_of_palm(const Vector3d& d) {
  std::vector<HandHold> holds;
  const Vector3d across = d.unitOrthogonal();
  for (int turn = 0; turn < 24; ++turn)
    for (const double tilt : {0.0, 12.0, -12.0}) {
      const Vector3d f0 = AngleAxisd(15.0 * turn * kDegree, d) * across;
      const Eigen::Matrix3d lean =
          AngleAxisd(tilt * kDegree, f0.cross(d).normalized()).toRotationMatrix();
      const Vector3d f = lean * f0;
      holds.push_back({f, lean * -d, -0.8 * f.x() + 0.2 * f.z() - 0.01 * std::abs(tilt)});
    }
  return holds;
}

}  // namespace

double lowest_point(std::span<const Capsule> capsules) {
  double lowest = std::numeric_limits<double>::infinity();
  for (const Capsule& c : capsules) lowest = std::min({lowest, c.a.z() - c.ra, c.b.z() - c.rb});
  return lowest;
}

PressSearch::PressSearch(Eigen::Matrix3Xd points, const Vector3d& eye)
    : points_(std::move(points)), some_(every_nth(points_, 700)), eye_(eye) {}

double PressSearch::score(const PressTarget& target, const PressRules& rules) const {
  const Vector3d to_eye = (eye_ - target.x).normalized();
  const double facing = target.direction.dot(to_eye);
  if (facing < rules.least_facing || facing > rules.most_facing || target.x.z() < 0.03 ||
      target.direction.x() > rules.most_x)
    return -1.0;
  // Presses from the right, at high places that face the eye, have the highest scores.
  return 1.0 + 1.2 * target.normal.dot(to_eye) - 0.6 * target.direction.x() +
         2.0 * std::min(target.x.z(), 0.1);
}

std::vector<RankedTarget> PressSearch::ranked(std::span<const PressTarget> targets,
                                              const PressRules& rules) const {
  std::vector<RankedTarget> list;
  for (const PressTarget& target : targets)
    if (const double points = score(target, rules); points > 0.0) list.push_back({target, points});
  std::stable_sort(list.begin(), list.end(),
                   [](const RankedTarget& a, const RankedTarget& b) { return a.score > b.score; });
  return list;
}

std::optional<Vector3d> PressSearch::first_touch(const Vector3d& x, const Vector3d& d,
                                                 const Quaterniond& turn, const HandTool& tool,
                                                 const ArmSide& arm) const {
  const Vector3d surface = x - tool.radius * d;
  double outside = -0.02;  // m along d
  double inside = 0.004;
  const auto touching = [&](double s) {
    const HandPose pose = pose_at_tip(tool, surface + s * d, turn, tool.working, arm);
    return touches(shapes_of(capsules_of(tool, pose)), points_);
  };
  if (touching(outside) || !touching(inside)) return std::nullopt;
  for (int i = 0; i < 20; ++i) {
    const double middle = 0.5 * (outside + inside);
    (touching(middle) ? inside : outside) = middle;
  }
  return Vector3d(surface + inside * d);
}

bool PressSearch::hides(std::span<const Capsule> hand, const Vector3d& x) const {
  constexpr double kItself = 0.003;  // m; the touching tip itself does not count as hiding x
  const double reach = (x - eye_).norm();
  return ray_distance(hand, eye_, (x - eye_) / reach, reach) < reach - kItself;
}

std::optional<PressPosture> PressSearch::posture(const PressTarget& target, double depth,
                                                 const HandTool& tool, const ArmSide& arm,
                                                 const PressRules& rules) const {
  const Vector3d& x = target.x;
  const Vector3d& d = target.direction;
  Eigen::Matrix3Xd rest(3, some_.cols());  // points of the body that the hand must not touch
  Eigen::Index count = 0;
  for (Eigen::Index i = 0; i < some_.cols(); ++i)
    if ((some_.col(i) - x).norm() > rules.near) rest.col(count++) = some_.col(i);
  rest.conservativeResize(3, count);

  const bool palm = tool.tip == HandTool::Tip::kFixed && tool.held.empty();
  const Vector3d tip = x + (depth - tool.radius) * d;
  std::optional<Quaterniond> best;
  double most = 0;
  for (const HandHold& hold : palm ? holds_of_palm(d) : holds_of_finger(d)) {
    if (best && kFreeWeight * kFree + hold.liking <= most)
      continue;  // cannot win with any clearance
    const Quaterniond turn = turn_for(tool, hold.pointing, hold.back);
    const auto hand_at = [&](const Vector3d& place) {
      return shapes_of(capsules_of(tool, pose_at_tip(tool, place, turn, tool.working, arm)));
    };
    const std::vector<Capsule> hand = hand_at(tip);
    const std::vector<Capsule> before = hand_at(tip - (rules.approach + depth) * d);
    if (std::min(lowest_point(hand), lowest_point(before)) < kDeskGap) continue;
    if (std::min(signed_distance(hand, eye_), signed_distance(before, eye_)) < rules.eye_clearance)
      continue;
    if (touches(before, some_)) continue;
    const double clearance = contact_truth(hand, rest, std::max(kFree, rules.clearance)).clearance;
    if (clearance < rules.clearance) continue;
    if (rules.seen && hides(hand, tip + tool.radius * d)) continue;
    const double score = kFreeWeight * std::min(clearance, kFree) + hold.liking;
    if (best && score <= most) continue;
    best = turn;
    most = score;
  }
  if (!best) return std::nullopt;
  const std::optional<Vector3d> touch = first_touch(x, d, *best, tool, arm);
  if (!touch) return std::nullopt;
  return PressPosture{target, *touch, *best, std::acos(d.dot((eye_ - x).normalized()))};
}

}  // namespace palpable
