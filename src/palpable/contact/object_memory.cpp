#include "palpable/contact/object_memory.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace palpable {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr int kCell = 4;        // px
constexpr int kMostParts = 6;   // that are followed; a desk holds two hands and what they hold
constexpr float kHides = 0.02f; // m: what of the room is so much nearer than a ball hides it
constexpr float kLeastLeft = 0.4f;  // of a ball's radius: less is not worth keeping
constexpr float kFacing = 0.15f;    // cosine; a front that is seen flatter is not measured again

struct Pixel {
  int x = 0, y = 0;
  float z = 0;  // m, of the point
  bool inside = false;
};

Pixel pixel_of(const Vector3f& point, const FrontView& view) {
  const Vector3d x = view.camera_from_body * point.cast<double>();
  if (!(x.z() > 0.01)) return {};
  const double u = view.camera.cx_px + view.camera.fx_px * x.x() / x.z();
  const double v = view.camera.cy_px + view.camera.fy_px * x.y() / x.z();
  const bool inside =
      u > -0.5 && v > -0.5 && u < view.camera.width - 0.5 && v < view.camera.height - 0.5;
  if (!inside) return {};
  return {static_cast<int>(std::lround(u)), static_cast<int>(std::lround(v)),
          static_cast<float>(x.z()), true};
}

std::uint8_t shown_at(const FrontView& view, const Pixel& p) {
  if (!p.inside) return kShowsUnknown;
  if (!view.shows.empty()) return view.shows(p.x, p.y);
  return view.depth(p.x, p.y) > 0 ? kShowsPresser : kShowsUnknown;
}

}  // namespace

int ObjectMemory::label_now(int part, const FrontView& view, const PartLabels& parts) const {
  std::array<int, 32> votes{};
  int best = PartLabels::kNone, most = 0;
  for (const ObjectBall& ball : before_) {
    if (ball.part != part || ball.unseen_for > 0) continue;
    const Pixel p = pixel_of(ball.point, view);
    if (!p.inside || !parts.box().contains(p.x, p.y)) continue;
    const int label = parts.at(p.x, p.y);
    if (label < 0 || label >= static_cast<int>(votes.size())) continue;
    if (++votes[static_cast<std::size_t>(label)] > most) {
      most = votes[static_cast<std::size_t>(label)];
      best = label;
    }
  }
  return best;
}

// Finds how each part has moved, and moves its balls along.
void ObjectMemory::follow_parts(const FrontView& view, const PartLabels& parts, double passed) {
  next_parts_.assign(static_cast<std::size_t>(parts.count()), {});
  for (int part = 0; part < static_cast<int>(parts_.size()); ++part) {
    Part& known = parts_[static_cast<std::size_t>(part)];
    front_.clear();
    if (part < kMostParts) {
      for (const ObjectBall& ball : before_) {
        if (ball.part == part && ball.unseen_for == 0) front_.push_back({ball.point, ball.normal});
      }
    }
    std::optional<RigidMotion> best;
    for (const bool goes_on : {true, false}) {
      const Rigid3 guess = goes_on && known.followed ? known.step : Rigid3::Identity();
      if (!goes_on && !known.followed) break;
      const auto found = rigid_motion(front_, view, guess, settings_.motion);
      if (found && (!best || found->agreeing > best->agreeing)) best = found;
      if (best && best->agreeing > 0.9 * best->points) break;
    }
    known.followed = best.has_value();
    known.step = best ? best->now_from_before : Rigid3::Identity();
    known.time = passed;
    for (ObjectBall& ball : before_) {
      if (ball.part == part) move(ball);
    }
    const int label = label_now(part, view, parts);
    if (label != PartLabels::kNone) next_parts_[static_cast<std::size_t>(label)] = known;
    for (ObjectBall& ball : before_) {
      if (ball.part == part) ball.part = -2 - std::max(label, 0);  // not to be met again
    }
  }
  for (ObjectBall& ball : before_) {
    if (ball.part <= -2) ball.part = -2 - ball.part;
  }
}

void ObjectMemory::move(ObjectBall& ball) const {
  const Part& part = parts_[static_cast<std::size_t>(ball.part)];
  if (!part.followed) {
    ball.frames = 0;  // nothing to average with
    return;
  }
  const Eigen::Matrix3f R = part.step.linear().cast<float>();
  const Vector3f t = part.step.translation().cast<float>();
  ball.point = R * ball.point + t;
  ball.normal = R * ball.normal;
  ball.centre = R * ball.centre + t;
}

// What has become of a ball that was moved to where it should be. A hidden one is made as small as
// the outline asks.
ObjectMemory::Fate ObjectMemory::fate_of(ObjectBall& ball, const FrontView& view,
                                         const Silhouette& silhouette) const {
  const Pixel front = pixel_of(ball.point, view), middle = pixel_of(ball.centre, view);
  const std::uint8_t there = shown_at(view, middle);
  if (there == kShowsUnknown) return Fate::kUnknown;
  const float z = view.depth(middle.x, middle.y);
  if (there == kShowsRoom) {
    const float nearest = middle.z - ball.radius;
    return z > 0 && z < nearest - kHides ? Fate::kUnknown : Fate::kGone;
  }
  // Something that presses is seen there.
  const float tolerance = std::max(0.003f, 3 * ball.sigma);
  if (shown_at(view, front) == kShowsPresser) {
    const float seen = view.depth(front.x, front.y);
    const Vector3f eye =
        view.camera_from_body.inverse(Eigen::Isometry).translation().cast<float>();
    const float facing = ball.normal.dot((eye - ball.point).normalized());
    if (facing > kFacing && std::abs(seen - front.z) < tolerance) return Fate::kSeenAgain;
    if (facing > kFacing && seen > front.z + tolerance) return Fate::kGone;
  }
  if (ball.frames == 0) return Fate::kGone;  // nobody knows where its thing went
  const float behind = middle.z - z;
  if (!(behind > 0)) return Fate::kGone;
  float radius = std::min(ball.radius, behind);
  if (silhouette.box().contains(middle.x, middle.y)) {
    const float disc =
        silhouette.distance(middle.x, middle.y) - static_cast<float>(settings_.fattening);
    if (std::isfinite(disc)) {
      radius = std::min(radius, disc * middle.z / static_cast<float>(view.camera.fx_px));
    }
  }
  if (radius < kLeastLeft * ball.radius) return Fate::kGone;
  ball.radius = radius;
  return Fate::kHidden;
}

void ObjectMemory::sort_into_cells(const FrontView& view, const PixelBox& box) {
  box_ = box;
  cells_across_ = box.width / kCell + 1;
  first_.assign(static_cast<std::size_t>(cells_across_) *
                    static_cast<std::size_t>(box.height / kCell + 1),
                -1);
  next_.resize(before_.size());
  for (const int k : seen_again_) {
    const Pixel p = pixel_of(before_[static_cast<std::size_t>(k)].point, view);
    if (!p.inside || !box.contains(p.x, p.y)) continue;
    int& head = first_[static_cast<std::size_t>((p.y - box.y) / kCell * cells_across_ +
                                                (p.x - box.x) / kCell)];
    next_[static_cast<std::size_t>(k)] = head;
    head = k;
  }
}

// Along the front's normal: across it neighbouring balls need not be the same as before.
void ObjectMemory::average(const FrontView& view, std::span<ObjectBall> balls) {
  const int rows = box_.height / kCell + 1;
  for (ObjectBall& ball : balls) {
    const Pixel p = pixel_of(ball.point, view);
    if (!p.inside || !box_.contains(p.x, p.y)) continue;
    const int i = (p.x - box_.x) / kCell, j = (p.y - box_.y) / kCell;
    const ObjectBall* same = nullptr;
    float nearest = static_cast<float>(
        std::max(settings_.same_least, settings_.same_share * static_cast<double>(ball.radius)));
    for (int b = std::max(j - 1, 0); b <= std::min(j + 1, rows - 1); ++b) {
      for (int a = std::max(i - 1, 0); a <= std::min(i + 1, cells_across_ - 1); ++a) {
        for (int k = first_[static_cast<std::size_t>(b * cells_across_ + a)]; k >= 0;
             k = next_[static_cast<std::size_t>(k)]) {
          const ObjectBall& other = before_[static_cast<std::size_t>(k)];
          const Vector3f apart = other.centre - ball.centre;
          const float across = (apart - apart.dot(ball.normal) * ball.normal).norm();
          if (across < nearest && std::abs(other.radius - ball.radius) < 0.3f * ball.radius) {
            nearest = across;
            same = &other;
          }
        }
      }
    }
    if (same == nullptr || same->frames == 0) continue;
    const float off = (same->centre - ball.centre).dot(ball.normal);
    if (std::abs(off) > static_cast<float>(settings_.same_sigmas) * ball.sigma) continue;
    const float known = std::min(same->frames, static_cast<float>(settings_.most_frames - 1));
    const float share = known / (known + 1);
    const Vector3f shift = share * off * ball.normal;
    ball.centre += shift;
    ball.point += shift;
    ball.radius += share * (same->radius - ball.radius);
    ball.frames = known + 1;
    ball.sigma /= std::sqrt(ball.frames);
  }
}

void ObjectMemory::merge(const FrontView& view, const Silhouette& silhouette,
                         const PartLabels& parts, double time, std::vector<ObjectBall>& balls) {
  const double passed = std::max(0.0, time - time_);
  time_ = time;
  follow_parts(view, parts, passed);
  seen_again_.clear();
  const std::size_t measured = balls.size();
  const auto hold = static_cast<float>(settings_.hold), fade = static_cast<float>(settings_.fade);
  for (std::size_t k = 0; k < before_.size(); ++k) {
    ObjectBall ball = before_[k];
    const Fate fate = fate_of(ball, view, silhouette);
    if (fate == Fate::kSeenAgain) seen_again_.push_back(static_cast<int>(k));
    if (fate == Fate::kSeenAgain || fate == Fate::kGone) continue;
    // A thing that could not be followed but is seen elsewhere has not vanished.
    if (fate == Fate::kUnknown && ball.frames == 0 && 2 * measured >= measured_before_) continue;
    ball.unseen_for += static_cast<float>(passed);
    ball.unknown_for = fate == Fate::kUnknown ? ball.unknown_for + static_cast<float>(passed) : 0;
    if (ball.unseen_for > static_cast<float>(settings_.remember)) continue;
    if (ball.unknown_for > hold + fade) continue;
    if (std::ssize(balls) < settings_.most_balls) balls.push_back(ball);
  }
  sort_into_cells(view, parts.box());
  average(view, std::span(balls).first(measured));
  before_.assign(balls.begin(), balls.end());
  measured_before_ = measured;
  std::swap(parts_, next_parts_);
  for (std::size_t k = measured; k < balls.size(); ++k) {
    const float left = (hold + fade - balls[k].unknown_for) / fade;
    balls[k].radius *= std::clamp(left, 0.0f, 1.0f);
  }
}

}  // namespace palpable
