#include "palpable/desk/script/squeezes.h"

#include "palpable/common/base/error.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/desk/script/camera_motions.h"
#include "palpable/desk/script/contact_truth.h"
#include "palpable/desk/script/hand_script.h"
#include "palpable/desk/script/press_search.h"
#include "palpable/desk/script/press_targets.h"
#include "palpable/desk/script/random.h"
#include "palpable/desk/script/seen_share.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

namespace palpable {

namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kSqueezeSpacing = 0.002;  // m, spacing of sample points on the body's surface
constexpr double kLeastWidth = 0.030;      // m, smallest width of a squeezed part
constexpr double kMostWidth = 0.070;       // m, largest width; the hand opens to 112 mm
constexpr double kLowest = 0.030;          // m, smallest height of a squeeze above the desk
constexpr double kNear = 0.024;           // m, radius round the two points where the hand may touch
constexpr double kClearance = 0.003;      // m, smallest gap to the rest of the body and the desk
constexpr double kFreeOfSqueeze = 0.010;  // m, clearance beyond which more is not better
constexpr double kEyeClearance = 0.10;    // m, smallest distance between hand and camera
constexpr double kOpening = 0.014;        // m, gap of each tip of the open hand from the body
constexpr double kBack = 0.090;           // m, distance that the open hand withdraws
constexpr double kApart = 0.015;          // m, smallest distance between squeezes
constexpr double kLeastSeen = 0.55;       // seen share of the touch; docs/benchmark.md states half
constexpr std::size_t kDifferent = 4;     // number of squeezes; then they are repeated
constexpr double kLeastDepth = 0.004;     // m, on each side
constexpr double kMostDepth = 0.006;      // m, on each side
// m, allowance for the depth where a tip reaches round a thin part.
constexpr double kDeeper = 0.002;

/// Two points of the surface with opposite normals. Desk frame.
struct TwoSides {
  Vector3d finger, thumb;  ///< where each of them touches
  double score = 0;

  [[nodiscard]] Vector3d axis() const { return (finger - thumb).normalized(); }
  [[nodiscard]] double width() const { return (finger - thumb).norm(); }
};

/// The posture of the hand for a squeeze.
struct SqueezeHold {
  TwoSides sides;
  Vector3d middle = Vector3d::Zero();  ///< midpoint of the tips at the full depth
  Quaterniond turn = Quaterniond::Identity();
  double closed = 0;                  ///< HandKey::open at the full depth
  double opened = 0;                  ///< HandKey::open before and after
  Vector3d back = Vector3d::UnitZ();  ///< unit, from where the open hand comes
  double liking = 0;
};

/// Pairs of points that can be squeezed, best first. Each pair occurs in both orders, since the
/// finger may be on either side.
std::vector<TwoSides> two_sides(const SurfacePoints& body, const Vector3d& eye) {
  std::vector<TwoSides> pairs;
  const Eigen::Index step = std::max<Eigen::Index>(1, body.points.cols() / 1200);
  for (Eigen::Index i = 0; i < body.points.cols(); i += step) {
    const Vector3d a = body.points.col(i), inwards = body.inwards.col(i);
    if (a.z() < kLowest) continue;
    // Among all points, the one most nearly opposite to a along both normals.
    std::optional<TwoSides> found;
    double best = 0.93;  // cosine between the line and both normals
    for (Eigen::Index j = 0; j < body.points.cols(); ++j) {
      const Vector3d way = body.points.col(j) - a;
      const double along = std::min(way.dot(inwards), -way.dot(Vector3d(body.inwards.col(j))));
      if (along <= 0.0 || body.points(2, j) < kLowest) continue;
      const double width = way.norm();
      if (width < kLeastWidth || width > kMostWidth) continue;
      const double straight = along / width;
      if (straight <= best) continue;
      best = straight;
      found = TwoSides{a, body.points.col(j), 0.0};
    }
    if (!found) continue;
    // The score is higher for axes across the line of sight, where both sides are seen, and for
    // high points.
    const Vector3d to_eye = (eye - 0.5 * (found->finger + found->thumb)).normalized();
    found->score = best - std::abs(found->axis().dot(to_eye)) + 4.0 * std::min(a.z(), 0.15);
    pairs.push_back(*found);
  }
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const TwoSides& a, const TwoSides& b) { return a.score > b.score; });
  return pairs;
}

double gap_between_tips(const HandTool& tool, double open) {
  const HandGesture gesture = blend(tool.working, tool.passing, open);
  return (index_tip_in_wrist(gesture) - thumb_tip_in_wrist(gesture)).norm();
}

/// HandKey::open for a distance between the centres of the tips, m; the distance increases with it.
double open_for(const HandTool& tool, double gap) {
  double low = 0.0, high = 1.0;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    (gap_between_tips(tool, middle) < gap ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// Searches postures for squeezing one body on the desk.
class SqueezeSearch {
 public:
  /// @param surface  of the body, body frame
  SqueezeSearch(const SurfacePoints& surface, const SurfaceDistance& body,
                const Rigid3& desk_from_body)
      : surface_(transformed(surface, desk_from_body)),
        body_(body),
        desk_from_body_(desk_from_body) {}

  [[nodiscard]] const SurfacePoints& surface() const { return surface_; }
  [[nodiscard]] const HandTool& tool() const { return tool_; }
  [[nodiscard]] const ArmSide& arm() const { return arm_; }

  /// The best posture; nothing when each violates a rule.
  [[nodiscard]] std::optional<SqueezeHold> hold(const TwoSides& sides, double depth) const {
    const double radii = index_tip_radius() + thumb_tip_radius();
    const double gap = sides.width() + radii - 2.0 * depth;
    const double opened_gap = sides.width() + radii + 2.0 * kOpening;
    if (gap < gap_between_tips(tool_, 0.0) || opened_gap > gap_between_tips(tool_, 1.0))
      return std::nullopt;
    SqueezeHold hold;
    hold.sides = sides;
    hold.closed = open_for(tool_, gap);
    hold.opened = open_for(tool_, opened_gap);
    hold.middle = 0.5 * (sides.finger + sides.thumb +
                         (index_tip_radius() - thumb_tip_radius()) * sides.axis());
    const HandGesture gesture = blend(tool_.working, tool_.passing, hold.closed);
    const Vector3d finger = index_tip_in_wrist(gesture), thumb = thumb_tip_in_wrist(gesture);
    const Vector3d to_palm = Vector3d(0.05, 0.0, 0.0) - 0.5 * (finger + thumb);
    const Eigen::Matrix3d in_wrist = frame_of(finger - thumb, to_palm);

    const Eigen::Matrix3Xd rest = far_from(sides);
    std::optional<SqueezeHold> best;
    for (int turn = 0; turn < 24; ++turn) {
      const Vector3d back = Eigen::AngleAxisd(15.0 * turn * kDegree, sides.axis()) *
                            Vector3d(sides.axis().unitOrthogonal());
      hold.back = back;
      hold.turn = Quaterniond(frame_of(sides.axis(), back) * in_wrist.transpose());
      // A right hand preferably comes from the right and from above, not from behind the body.
      const auto liking = [&](double clearance) {
        return back.x() + 0.7 * back.z() - 0.3 * back.y() + 20.0 * clearance;
      };
      if (best && liking(kFreeOfSqueeze) <= best->liking) continue;
      const double clearance = clearance_of(hold, rest);
      if (clearance < kClearance) continue;
      hold.liking = liking(clearance);
      if (best && hold.liking <= best->liking) continue;
      if (share_seen(hold) < kLeastSeen) continue;
      best = hold;
    }
    return best;
  }

  [[nodiscard]] std::vector<Capsule> hand_at(const SqueezeHold& hold, const Vector3d& middle,
                                             double open) const {
    const HandGesture gesture = blend(tool_.working, tool_.passing, open);
    return shapes_of(capsules_of(tool_, pose_at_tip(tool_, middle, hold.turn, gesture, arm_)));
  }

 private:
  [[nodiscard]] Eigen::Matrix3Xd far_from(const TwoSides& sides) const {
    Eigen::Matrix3Xd rest(3, surface_.points.cols());
    Eigen::Index count = 0;
    for (Eigen::Index i = 0; i < surface_.points.cols(); ++i) {
      const Vector3d x = surface_.points.col(i);
      if (std::min((x - sides.finger).norm(), (x - sides.thumb).norm()) > kNear)
        rest.col(count++) = x;
    }
    return rest.leftCols(count);
  }

  /// m, clearance of the closed hand from the rest of the body, at most kFreeOfSqueeze; negative
  /// when a rule is violated during the motion.
  [[nodiscard]] double clearance_of(const SqueezeHold& hold, const Eigen::Matrix3Xd& rest) const {
    const std::vector<Capsule> closed = hand_at(hold, hold.middle, hold.closed);
    if (lowest_point(closed) < kClearance || signed_distance(closed, first_eye()) < kEyeClearance)
      return -1.0;
    for (const double way : {0.0, 0.25, 0.5, 0.75, 1.0}) {
      const std::vector<Capsule> open =
          hand_at(hold, hold.middle + way * kBack * hold.back, hold.opened);
      if (lowest_point(open) < kClearance || signed_distance(open, first_eye()) < kEyeClearance ||
          touches(open, surface_.points))
        return -1.0;
    }
    const ContactTruth truth = contact_truth(closed, rest, kFreeOfSqueeze);
    return truth.touching ? -1.0 : truth.clearance;
  }

  [[nodiscard]] double share_seen(const SqueezeHold& hold) const {
    const std::vector<Capsule> hand =
        transformed(hand_at(hold, hold.middle, hold.closed), desk_from_body_.inverse());
    const Rigid3 camera_from_body = first_camera_from_desk() * desk_from_body_;
    const Eigen::Matrix3Xd part = touching_part(hand, body_, kSqueezeSpacing, 200);
    return seen_share(camera_from_body * part, transformed(hand, camera_from_body), eyes_);
  }

  SurfacePoints surface_;  // desk frame
  const SurfaceDistance& body_;
  Rigid3 desk_from_body_;
  RectifiedStereo eyes_{zed_mini_rig().left.pinhole, 0.063};
  HandTool tool_ = pinching_hand();
  ArmSide arm_;
};

/// Builds the path of the hand, which enters and then alternately squeezes and rests.
class SqueezeScript {
 public:
  /// @param first  first frame of the path, in which the hand is outside of the picture
  /// @param pace   ratio by which all motions are slowed down
  SqueezeScript(const SqueezeSearch& search, std::uint64_t seed, double first = kFramesWithoutHand,
                double pace = 1)
      : search_(search), pace_(pace), rest_turn_(resting_turn()) {
    path_.tool = search.tool();
    path_.arm = search.arm();
    path_.tremor_seed = seed;
    rest_ = tip_for_knuckles(path_.tool, {0.27, 0.05, 0.16}, rest_turn_);
    path_.keys.push_back(
        {first, tip_for_knuckles(path_.tool, {0.62, 0.16, 0.26}, rest_turn_), rest_turn_, 0.7});
    path_.keys.push_back({first + 18 * pace_, rest_, rest_turn_, 0.7});
  }

  [[nodiscard]] double now() const { return path_.keys.back().frame; }
  [[nodiscard]] const HandPath& path() const { return path_; }
  void wait(double frames) { key(now() + frames, rest_, rest_turn_, 0.7); }

  /// Adds a squeeze. @return the frames outside of which nothing touches; nothing, without adding
  /// the squeeze, when the hand would touch the desk, touch elsewhere, or not touch with both tips
  std::optional<FrameSpan> squeeze(const SqueezeHold& hold, double depth, double in,
                                   double hold_frames) {
    const std::size_t keys_before = path_.keys.size();
    const double start = now(), first = start + 28 * pace_;
    const Vector3d before = hold.middle + kBack * hold.back;
    key(start + 16 * pace_, before, hold.turn, hold.opened);
    key(first, hold.middle, hold.turn, hold.opened);
    key(first + in, hold.middle, hold.turn, hold.closed);
    key(first + in + hold_frames, hold.middle, hold.turn, hold.closed);
    const double last = first + in + hold_frames + std::max(8.0, 0.75 * in);
    key(last, hold.middle, hold.turn, hold.opened);
    key(last + 12 * pace_, before, hold.turn, hold.opened);
    key(last + 28 * pace_, rest_, rest_turn_, 0.7);
    const FrameSpan frames{static_cast<int>(std::floor(first)), static_cast<int>(std::ceil(last))};
    if (squeezes_only(hold, depth, frames, start, first + in + 0.5 * hold_frames)) return frames;
    path_.keys.resize(keys_before);
    return std::nullopt;
  }

 private:
  void key(double at, const Vector3d& middle, const Quaterniond& turn, double open) {
    path_.keys.push_back({at, middle, turn, open});
  }

  [[nodiscard]] bool squeezes_only(const SqueezeHold& hold, double depth, FrameSpan frames,
                                   double start, double deepest) const {
    const SurfacePoints& surface = search_.surface();
    for (int frame = static_cast<int>(std::ceil(start)); frame <= std::floor(now()); ++frame) {
      const std::vector<Capsule> hand = shapes_of(path_.capsules(frame));
      if (lowest_point(hand) < 0.0) return false;
      const PressTruth truth = press_truth(hand, surface);
      if (!truth.touching) continue;
      const Vector3d x = surface.points.col(truth.point);
      if (frame < frames.first || frame > frames.last || truth.depth > depth + kDeeper ||
          std::min((x - hold.sides.finger).norm(), (x - hold.sides.thumb).norm()) > kNear)
        return false;
    }
    const std::vector<Capsule> hand = shapes_of(path_.capsules(std::round(deepest)));
    return touches({&hand[kIndexTip], 1}, surface.points) &&
           touches({&hand[kThumbTip], 1}, surface.points);
  }

  const SqueezeSearch& search_;
  double pace_;
  Quaterniond rest_turn_;
  Vector3d rest_;
  HandPath path_;
};

/// The planned touches of finger and thumb in one squeeze.
std::array<PlannedTouch, 2> touches_of(const SqueezeHold& hold, double depth, FrameSpan frames,
                                       double in, const DeskBody& body,
                                       const Rigid3& desk_from_body) {
  std::array<PlannedTouch, 2> both;
  for (const bool is_thumb : {false, true}) {
    PlannedTouch& touch = both[is_thumb ? 1 : 0];
    const Vector3d& x = is_thumb ? hold.sides.thumb : hold.sides.finger;
    touch.what = is_thumb ? "thumb" : "finger";
    touch.site = nearest_site(body, desk_from_body.inverse() * x);
    touch.between = true;  // the target is not a site
    touch.depth = depth;
    touch.frames = frames;
    touch.seconds_to_depth = in / kFramesPerSecond;
    touch.direction = (is_thumb ? 1.0 : -1.0) * hold.sides.axis();
    touch.first_touch = x - (is_thumb ? thumb_tip_radius() : index_tip_radius()) * touch.direction;
    touch.view_angle = std::acos(touch.direction.dot((first_eye() - x).normalized()));
  }
  return both;
}

/// A sequence for one rotation of the body; nothing when no squeeze is possible.
std::optional<Sequence> attempt_squeezes(const DeskBody& body, const SurfaceDistance& distance,
                                         const SurfacePoints& surface, double yaw, int frames,
                                         std::uint64_t seed) {
  Sequence sequence = tripod_sequence("squeeze", frames, seed);
  sequence.desk_from_body = turned_body(yaw);
  const SqueezeSearch search(surface, distance, sequence.desk_from_body);
  SqueezeScript script(search, seed);
  Random random(seed, "squeeze");

  struct Done {
    SqueezeHold hold;
    double depth;
  };
  std::vector<Done> done;
  const auto add = [&](const TwoSides& sides, double depth) {
    const std::optional<SqueezeHold> hold = search.hold(sides, depth);
    if (!hold) return false;
    const double in = random.between(10, 24), stay = random.between(10, 24);
    const std::optional<FrameSpan> span = script.squeeze(*hold, depth, in, stay);
    if (!span) return false;
    done.push_back({*hold, depth});
    for (PlannedTouch& touch : touches_of(*hold, depth, *span, in, body, sequence.desk_from_body))
      sequence.touches.push_back(std::move(touch));
    script.wait(random.between(4, 12));
    return true;
  };
  const auto next_depth = [&] { return random.between(kLeastDepth, kMostDepth); };
  int tried = 0;
  for (const TwoSides& sides : two_sides(search.surface(), first_eye())) {
    if (done.size() >= kDifferent || script.now() >= frames || tried >= 60) break;
    const bool apart = std::all_of(done.begin(), done.end(), [&](const Done& other) {
      return (other.hold.sides.finger - sides.finger).norm() > kApart;
    });
    if (!apart) continue;
    ++tried;
    add(sides, next_depth());
  }
  if (done.empty() && script.now() < frames) return std::nullopt;
  for (std::size_t i = 0; script.now() < frames; ++i) {
    const TwoSides sides = done[i % done.size()].hold.sides;
    if (!add(sides, done[i % done.size()].depth)) script.wait(20);
  }
  sequence.movers = hand_alone(script.path());
  std::erase_if(sequence.touches, [&](const PlannedTouch& t) { return t.frames.first >= frames; });
  return sequence;
}

}  // namespace

std::optional<OneSqueeze> plan_one_squeeze(const DeskBody& body, const Rigid3& desk_from_body,
                                           double first, double pace, std::uint64_t seed) {
  constexpr int kTried = 60;
  constexpr double kDepth = 0.5 * (kLeastDepth + kMostDepth);
  const SurfaceDistance distance(body.surface);
  const SqueezeSearch search(sample_surface(body.surface, kSqueezeSpacing), distance,
                             desk_from_body);
  SqueezeScript script(search, seed, first, pace);
  const double in = 14 * pace, stay = 14 * pace;
  int tried = 0;
  for (const TwoSides& sides : two_sides(search.surface(), first_eye())) {
    if (++tried > kTried) break;
    const std::optional<SqueezeHold> hold = search.hold(sides, kDepth);
    if (!hold) continue;
    const std::optional<FrameSpan> span = script.squeeze(*hold, kDepth, in, stay);
    if (!span) continue;
    const auto both = touches_of(*hold, kDepth, *span, in, body, desk_from_body);
    return OneSqueeze{script.path(), {both.begin(), both.end()}};
  }
  return std::nullopt;
}

Sequence plan_squeezes(const DeskBody& body, int frames, std::uint64_t seed) {
  const SurfaceDistance distance(body.surface);
  const SurfacePoints surface = sample_surface(body.surface, kSqueezeSpacing);
  Random random(seed, "squeeze-yaw");
  const double first = random.between(0.0, 2.0 * std::numbers::pi);
  for (int turn = 0; turn < 12; ++turn) {
    const double yaw =
        first + 150.0 * turn * kDegree;  // far from the last one; visits each of 12 once
    if (auto sequence = attempt_squeezes(body, distance, surface, yaw, frames, seed))
      return *std::move(sequence);
  }
  throw Error(
      "the sequence 'squeeze' cannot be planned for this body: nowhere are two of its sides 30 to "
      "70 mm apart so that finger and thumb can come round them");
}

}  // namespace palpable
