#include "palpable/contact/skin_contact.h"

#include <algorithm>
#include <cstddef>
#include <optional>

namespace palpable {
namespace {

using Eigen::Vector3f;

// m: pressed points that lie so near to each other, and are pushed the same way, are of one touch.
constexpr float kOneTouch = 0.006f;

// m that a vertex may go from one frame to the next, or as far as what presses was seen to move: an
// object's unseen side is guessed anew in each frame, and jumps where nothing moved.
constexpr double kMove = 0.00375;

// m of sigma that make a point as compliant as the body is there.
constexpr float kSigmaOfBody = 0.01f;

// What the solver asks of the surface that was seen.
GapQuery gaps_to(const ObjectSurface& seen) {
  const auto reach = static_cast<float>(seen.settings().band);
  return [&seen, reach](const Vector3f& place, SurfaceGap& gap) {
    if (!(seen.bounds().squaredExteriorDistance(place) < reach * reach)) return false;
    const std::optional<SurfaceShape> shape = seen.shape_at(place);
    if (!shape) return false;
    gap.distance = shape->distance;
    gap.normal = shape->normal;
    gap.curvature = shape->curvature;
    gap.softness = shape->sigma / kSigmaOfBody;
    return true;
  };
}

NearQuery near_to(const ObjectSurface& seen) {
  const auto band = static_cast<float>(seen.settings().band);
  return [&seen, band](const Vector3f& place, float reach) {
    const float asked = std::min(reach, band);
    return seen.bounds().squaredExteriorDistance(place) < asked * asked &&
           seen.is_within(place, asked);
  };
}

}  // namespace

SkinContact::SkinContact(const SurfaceMesh& skin, std::span<const std::uint8_t> fixed,
                         const TouchTables& tables, const TouchSettings& settings)
    : solver_(skin, fixed, tables, settings) {
  pressed_.reserve(2 * TouchSolver::kMostPoints);
  moved_.reserve(2 * TouchSolver::kMostPoints);
}

TouchReport SkinContact::advance(TouchState& state, const ObjectSurface& seen,
                                 std::vector<Touch>& touches) {
  touches.clear();
  touches.reserve(TouchSolver::kMostPoints);
  TouchReport report;
  if (seen.balls().empty() && state.forces.empty() && state.u.cols() > 0) {
    return report;  // at rest, and stays so
  }
  report = solver_.advance(state, gaps_to(seen), near_to(seen), std::max(kMove, seen.moved()));
  find_pressed(state);
  join_neighbours();
  for (int patch = 0; patch < patches_; ++patch) touches.push_back(touch_of(patch, seen));
  std::sort(touches.begin(), touches.end(),
            [](const Touch& a, const Touch& b) { return a.force > b.force; });
  return report;
}

void SkinContact::find_pressed(const TouchState& state) {
  pressed_.clear();
  solver_.find_moved(state, moved_);
  for (std::size_t k = 0; k < moved_.size(); ++k) {
    const PointForce& at = state.forces[k];
    const SkinPoint& point = solver_.points()[static_cast<std::size_t>(at.point)];
    pressed_.push_back(
        {solver_.places().col(at.point) + moved_[k], moved_[k], at.force, point.area});
  }
}

// Numbers the patches, by their first points.
void SkinContact::join_neighbours() {
  const int n = static_cast<int>(pressed_.size());
  const auto root = [&](int i) {
    while (pressed_[i].first != i) i = pressed_[i].first;
    return i;
  };
  for (int i = 0; i < n; ++i) {
    pressed_[i].first = i;
    for (int j = 0; j < i; ++j) {
      const bool near =
          (pressed_[i].place - pressed_[j].place).squaredNorm() < kOneTouch * kOneTouch;
      if (!near || !(pressed_[i].force.dot(pressed_[j].force) > 0)) continue;
      const int a = root(i), b = root(j);
      pressed_[std::max(a, b)].first = std::min(a, b);
    }
  }
  patches_ = 0;
  for (int i = 0; i < n; ++i) {
    const int r = root(i);
    pressed_[i].patch = r == i ? patches_++ : pressed_[r].patch;
  }
}

Touch SkinContact::touch_of(int patch, const ObjectSurface& seen) const {
  Touch touch;
  Vector3f force = Vector3f::Zero(), place = Vector3f::Zero();
  float weight = 0, assumed = 0;
  for (const Pressed& p : pressed_) {
    if (p.patch != patch) continue;
    const float w = p.force.norm();
    force += p.force;
    place += w * p.place;
    weight += w;
    touch.area += static_cast<double>(p.area);
    const std::optional<NearestOnObject> at =
        seen.nearest(p.place, static_cast<float>(seen.settings().band));
    if (!at) continue;
    if (at->known != Known::kMeasured) assumed += w;
    touch.unseen_for =
        std::max(touch.unseen_for, static_cast<double>(seen.balls()[at->ball].unseen_for));
  }
  touch.force = static_cast<double>(force.norm());
  touch.direction = force.cast<double>().normalized();
  if (weight > 0) {
    touch.point_in_body = (place / weight).cast<double>();
    touch.assumed = static_cast<double>(assumed / weight);
  }
  for (const Pressed& p : pressed_) {
    if (p.patch != patch) continue;
    touch.press_depth = std::max(touch.press_depth, p.moved.cast<double>().dot(touch.direction));
  }
  return touch;
}

}  // namespace palpable
