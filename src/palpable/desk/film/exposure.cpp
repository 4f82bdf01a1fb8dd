#include "palpable/desk/film/exposure.h"

#include "palpable/desk/film/seen_box.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace palpable {

namespace {

constexpr double kNearStill = 0.4;    // m, assumed distance of the nearest still thing
constexpr double kReferencePx = 2.0;  // px, largest parallax between references
constexpr double kLookPx = 2.0;       // px, largest motion of the picture between looks
constexpr double kMoverPx = 4.0;      // px, largest motion of the movers between layers
constexpr int kMost = 10;             // parts into which each of the three motions is divided
// share() rounds up: all layers < kMost + references <= 2 kMost, all looks < kMost + all layers.
static_assert(2 * kMost <= kMostLayers && 3 * kMost <= kMostLooks);

/// Motion of the movers in the picture between two instants, px: the largest motion of a point on
/// the axis of a capsule that is in view.
double mover_motion_px(const PinholeCamera& view, const Rigid3& first, const Movers& before,
                       const Rigid3& last, const Movers& after) {
  const auto in_view = [&](const Eigen::Vector3d& x, double radius) {
    const Eigen::Vector2d at = view.project(x);
    const double reach = view.fx_px * radius / x.z();
    return at.x() > -reach && at.x() < view.width + reach && at.y() > -reach &&
           at.y() < view.height + reach;
  };
  double most = 0;
  for (std::size_t i = 0; i < before.capsules.size(); ++i) {
    const Capsule& c = before.capsules[i].shape;
    const Capsule& d = after.capsules[i].shape;
    for (const double along : {0.0, 0.25, 0.5, 0.75, 1.0}) {
      const Eigen::Vector3d x = first * (c.a + along * (c.b - c.a));
      const Eigen::Vector3d y = last * (d.a + along * (d.b - d.a));
      const double radius = c.ra + along * (c.rb - c.ra);
      // Points this near to the plane of the eye can only appear at the border of the picture.
      if (std::min(x.z(), y.z()) <= SeenBox::kNearest) continue;
      if (in_view(x, radius) || in_view(y, radius))
        most = std::max(most, (view.project(x) - view.project(y)).norm());
    }
  }
  return most;
}

int parts(double px, double px_each) {
  return std::clamp(static_cast<int>(std::ceil(px / px_each)), 1, kMost);
}

/// Number of parts per group, so that `among` groups have at least `count` parts together.
int share(int count, int among) { return (count + among - 1) / among; }

}  // namespace

std::pair<Movers, Movers> movers_between(const DeskMoment& frame, double opens, double closes) {
  std::pair<Movers, Movers> movers(frame.movers(opens), frame.movers(closes));
  const auto& [first, last] = movers;
  const bool same_things =
      first.desk_from_cup.has_value() == last.desk_from_cup.has_value() &&
      std::equal(first.capsules.begin(), first.capsules.end(), last.capsules.begin(),
                 last.capsules.end(), [](const HandCapsule& a, const HandCapsule& b) {
                   return a.part == b.part && a.shape.ra == b.shape.ra && a.shape.rb == b.shape.rb;
                 });
  if (!same_things) movers.first = movers.second = frame.movers(frame.frame);
  return movers;
}

Exposure split_exposure(const PinholeCamera& view, const Rigid3& eye_from_camera,
                        const DeskMoment& frame) {
  const double half = 0.5 * frame.rig.exposure * kFramesPerSecond;  // frames
  Exposure exposure;
  exposure.opens = frame.frame - half;
  exposure.closes = frame.frame + half;
  if (half == 0.0) return exposure;
  const Rigid3 first = eye_from_camera * frame.camera_from_desk(exposure.opens);
  const Rigid3 last = eye_from_camera * frame.camera_from_desk(exposure.closes);
  const Rigid3 change = last * first.inverse();
  const double turn = view.fx_px * Eigen::AngleAxisd(change.linear()).angle();
  const double shift = view.fx_px * change.translation().norm() / kNearStill;
  const auto [before, after] = movers_between(frame, exposure.opens, exposure.closes);
  const double moved = mover_motion_px(view, first, before, last, after);
  const int looks = parts(turn, kLookPx);
  exposure.references = parts(shift, kReferencePx);
  exposure.layers = share(parts(moved, kMoverPx), exposure.references);
  exposure.looks = share(looks, exposure.references * exposure.layers);
  exposure.turns = looks > 1;
  return exposure;
}

}  // namespace palpable
