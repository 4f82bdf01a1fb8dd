#include "palpable/desk/script/presses.h"

#include "palpable/common/base/error.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/desk/script/camera_motions.h"
#include "palpable/desk/script/hand_script.h"
#include "palpable/desk/script/press_style.h"
#include "palpable/desk/script/press_targets.h"
#include "palpable/desk/script/random.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace palpable {

namespace {

constexpr double kPointSpacing = 0.0015;  // m; a pencil's tip has a radius of 1.2 mm

/// The body on the desk for a right hand, or its mirror image for a left hand.
struct Desk {
  SurfacePoints surface;
  PressSearch search;
  std::vector<PressTarget> sites, between;
};

Desk desk_with(const DeskBody& body, const SurfacePoints& surface, const Rigid3& desk_from_body) {
  SurfacePoints in_desk = transformed(surface, desk_from_body);
  PressSearch search(in_desk.points, first_eye());
  return {std::move(in_desk), std::move(search), site_targets(body, desk_from_body),
          between_targets(body, desk_from_body)};
}

Desk mirror_desk(const Desk& desk) {
  return {mirror_image(desk.surface), mirror_image(desk.search), mirror_image(desk.sites),
          mirror_image(desk.between)};
}

/// Chooses the presses of one hand: alternately at sites and between sites, the best seen first.
class PressChoice {
 public:
  /// All arguments must outlive this object.
  PressChoice(HandScript& script, const Desk& desk, const PressStyle& style, Random& random)
      : script_(script),
        search_(desk.search),
        style_(style),
        random_(random),
        targets_{desk.search.ranked(desk.sites, style.rules),
                 desk.search.ranked(desk.between, style.rules)},
        share_(random.unit()),
        begins_(random.unit() < 0.5 ? 0 : 1) {}

  /// Adds presses until the hand's script has this many frames. Returns false when none is
  /// possible.
  bool fill(int frames) {
    for (int press = 0; script_.now() < frames; ++press) {
      const double depth = next_depth();
      if (style_.turns && !turn_in_view()) return false;
      if (done_.size() >= kDifferent || !press_new_target(press, depth)) {
        if (done_.empty()) return false;
        press_again(press, depth);
      }
      if (!style_.comes_near) script_.wait(random_.between(4, 14));
      if (style_.comes_near && press % 4 == 0) script_.pass_the_lens(34);
      if (style_.comes_near && press % 4 == 2) script_.work_in_front(44);
    }
    return true;
  }

 private:
  static constexpr std::size_t kDifferent = 6;  // number of targets; then they are pressed again
  static constexpr double kApart = 0.012;       // m, smallest distance between targets

  /// A press that is in the script.
  struct Done {
    PressPosture posture;
    PressTarget end;  // end of a slide
    double depth;
  };

  /// The next depth, m. The fractional parts of multiples of the golden ratio are spread evenly
  /// over 0..1 for any start, so the depths are spread evenly over their range.
  double next_depth() {
    share_ = std::fmod(share_ + std::numbers::phi - 1.0, 1.0);
    return style_.least_depth + share_ * (style_.most_depth - style_.least_depth);
  }

  /// The next pace, between a fast tap and a slow push; successive presses differ in speed.
  HandScript::Pace next_pace(int press) {
    constexpr std::array<double, 5> kIn = {14, 7, 20, 10, 30};
    const double in = kIn[press % kIn.size()] + random_.between(-1, 1);
    const double hold = random_.between(style_.least_hold, style_.most_hold);
    return {in, hold, std::max(7.0, 0.75 * in)};
  }

  bool turn_in_view() {
    const double angle = random_.between(180.0, 195.0) * kDegree;
    const double frames = random_.between(48.0, 84.0);  // 1.6 to 2.8 s
    return script_.turn_in_view(angle, frames);
  }

  /// Presses the next possible target; of the other kind when this kind has none left.
  bool press_new_target(int press, double depth) {
    const std::size_t kind = (begins_ + press) % 2;
    for (const std::size_t k : {kind, 1 - kind})
      while (next_[k] < targets_[k].size()) {
        const PressTarget& target = targets_[k][next_[k]++].target;
        const bool apart = std::all_of(done_.begin(), done_.end(), [&](const Done& other) {
          return (other.posture.target.x - target.x).norm() > kApart;
        });
        if (!apart) continue;
        const auto posture = search_.posture(target, depth, style_.tool, style_.arm, style_.rules);
        if (!posture) continue;
        const HandScript::Pace pace = next_pace(press);
        if (style_.slides ? slide_from(*posture, depth, pace) : press_at(*posture, depth, pace))
          return true;
      }
    return false;
  }

  bool press_at(const PressPosture& posture, double depth, const HandScript::Pace& pace) {
    if (!script_.press(posture, depth, pace)) return false;
    done_.push_back({posture, {}, depth});
    return true;
  }

  /// Slides to the first target at a suitable distance that can be reached.
  bool slide_from(const PressPosture& posture, double depth, const HandScript::Pace& pace) {
    for (const auto& list : targets_)
      for (const RankedTarget& end : list) {
        const double way = (end.target.x - posture.target.x).norm();
        if (way < 0.025 || way > 0.07) continue;
        if (!script_.slide(posture, end.target, depth, pace)) continue;
        done_.push_back({posture, end.target, depth});
        return true;
      }
    return false;
  }

  /// Repeats an earlier press, not deeper than before because its posture was found for that depth.
  void press_again(int press, double depth) {
    const Done& earlier = done_[press % done_.size()];
    const HandScript::Pace pace = next_pace(press);
    const double again = std::min(depth, earlier.depth);
    const bool done = style_.slides ? script_.slide(earlier.posture, earlier.end, again, pace)
                                    : script_.press(earlier.posture, again, pace);
    if (!done) script_.wait(20);
  }

  HandScript& script_;
  const PressSearch& search_;
  const PressStyle& style_;
  Random& random_;
  std::array<std::vector<RankedTarget>, 2> targets_;  // sites, and points between them
  std::array<std::size_t, 2> next_ = {0, 0};          // the first target not yet tried
  double share_;        // 0..1 in the range of depths; must be drawn before begins_
  std::size_t begins_;  // index in targets_ of the kind that is pressed first
  std::vector<Done> done_;
};

/// The approximate smallest gap between two hands, m, from balls at the ends and the middle of each
/// capsule of the first hand to the surface of the second.
double gap(const std::vector<Capsule>& first, const std::vector<Capsule>& second) {
  double least = 1.0;
  for (const Capsule& c : first)
    least =
        std::min({least, signed_distance(second, c.a) - c.ra, signed_distance(second, c.b) - c.rb,
                  signed_distance(second, 0.5 * (c.a + c.b)) - 0.5 * (c.ra + c.rb)});
  return least;
}

bool hands_meet(const HandPath& right, const HandPath& mirrored_left, int frames) {
  for (int frame = kFramesWithoutHand; frame < frames; frame += 2)
    if (gap(shapes_of(right.capsules(frame)), shapes_of(mirrored(mirrored_left.capsules(frame)))) <=
        0.0)
      return true;
  return false;
}

/// The right hand and, if there is one, the left hand, whose path is given as its mirror image.
Movers hands_at(double frame, const HandPath& right, const std::optional<HandPath>& mirrored_left) {
  Movers movers;
  if (frame < kFramesWithoutHand) return movers;
  movers.capsules = right.capsules(frame);
  if (!mirrored_left) return movers;
  const std::vector<HandCapsule> left = mirrored(mirrored_left->capsules(frame));
  movers.capsules.insert(movers.capsules.end(), left.begin(), left.end());
  return movers;
}

/// A sequence, or the reason why there is none for this rotation of the body.
struct Attempt {
  std::optional<Sequence> sequence;
  std::string why_not;
};

Attempt attempt_presses(std::string_view name, const PressStyle& style, const DeskBody& body,
                        const SurfacePoints& surface, double yaw, int frames, std::uint64_t seed) {
  Sequence sequence = tripod_sequence(name, frames, seed);
  sequence.desk_from_body = turned_body(yaw);
  sequence.look.left_free = style.two_hands;

  Random random(seed, name);
  const Desk desk = desk_with(body, surface, sequence.desk_from_body);
  HandScript right(desk.search, desk.surface, style, seed);
  if (!PressChoice(right, desk, style, random).fill(frames)) return {{}, right.why_not()};
  sequence.touches = right.touches();
  sequence.spans = right.spans();

  std::optional<HandPath> mirrored_left;
  if (style.two_hands) {
    const Desk mirrored_desk = mirror_desk(desk);
    HandScript left(mirrored_desk.search, mirrored_desk.surface, style, seed + 1);
    if (!PressChoice(left, mirrored_desk, style, random).fill(frames)) return {{}, left.why_not()};
    for (PlannedTouch touch : left.touches()) {
      touch.first_touch.x() = -touch.first_touch.x();
      touch.direction.x() = -touch.direction.x();
      sequence.touches.push_back(touch);
    }
    mirrored_left = left.path();
    if (hands_meet(right.path(), *mirrored_left, frames)) return {{}, "the two hands would meet"};
  }
  sequence.movers = [right = right.path(), mirrored_left](double frame) {
    return hands_at(frame, right, mirrored_left);
  };
  // Only whole presses are planned, so the last may begin after the end of the sequence.
  std::erase_if(sequence.touches, [&](const PlannedTouch& t) { return t.frames.first >= frames; });
  std::erase_if(sequence.spans, [&](const NamedSpan& s) { return s.frames.first >= frames; });
  return {std::move(sequence), ""};
}

}  // namespace

Sequence plan_presses(std::string_view name, const DeskBody& body, int frames, std::uint64_t seed) {
  const PressStyle style = press_style(name);
  const SurfacePoints surface = sample_surface(body.surface, kPointSpacing);
  // The seed determines which of the four best rotations is tried first.
  std::vector<double> yaws = yaws_to_press(body, style.rules, 6, style.two_hands);
  if (yaws.size() >= 4) std::rotate(yaws.begin(), yaws.begin() + seed % 4, yaws.begin() + 4);

  std::string why = "no site is where this sequence can press it";
  for (const double yaw : yaws) {
    Attempt tried = attempt_presses(name, style, body, surface, yaw, frames, seed);
    if (tried.sequence) return *std::move(tried.sequence);
    why = tried.why_not;
  }
  throw Error(
      fmt::format("the sequence '{}' cannot be planned for this body: {}; the body should be "
                  "0.05 to 0.25 m high and have sites on several sides",
                  name, why));
}

}  // namespace palpable
