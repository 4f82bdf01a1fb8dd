#include "palpable/desk/script/demo.h"

#include "palpable/common/base/error.h"
#include "palpable/desk/script/camera_motions.h"
#include "palpable/desk/script/contact_truth.h"
#include "palpable/desk/script/hand_script.h"
#include "palpable/desk/script/press_targets.h"
#include "palpable/desk/script/random.h"
#include "palpable/desk/script/squeezes.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace palpable {

namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

/// Frames with a hand for which the motion is written; it is stretched to the requested length.
constexpr double kScriptLength = 330.0;
constexpr double kSqueezeBegins = 240.0;  // in frames of the script
constexpr int kTargets = 500;             // candidate targets on the skin
constexpr int kSqueezesTried = 3;         // rotations of the body for which a squeeze is tried
constexpr double kLean = 0.45;            // tilt of presses towards the left, see skin_targets()

/// A place of the body that is pressed for the viewer to see.
struct Place {
  double low, high;          // bounds of the height, ratio to the body's height
  double least_up, most_up;  // bounds of the normal's z
  double facing;             // wanted cosine between the press and the direction to the eye
  double depth;              // m
};
/// A dent and its stress are clearly visible when the press is directed slightly away from the eye.
/// But then the tip hides the touching surface, and the touch is not scored (seen_share.h). So one
/// place lies at the body's outline instead, and so do both sides of the squeeze.
constexpr std::array<Place, 3> kPlaces{{{0.25, 0.60, -0.3, 0.5, -0.25, 0.010},    // a flank
                                        {0.40, 0.80, 0.75, 1.0, -0.30, 0.010},    // the back
                                        {0.62, 0.90, -0.4, 0.6, 0.20, 0.0085}}};  // an ear's root
constexpr std::size_t kPresses = kPlaces.size();

PressRules demo_rules() {
  PressRules rules;
  rules.least_facing = -0.75;
  rules.most_facing = 0.5;
  rules.most_x = -0.25;
  rules.seen = false;  // the tip itself hides the place that it touches
  rules.eye_clearance = 0.0;
  return rules;
}

std::array<double, kPresses> demo_depths(std::uint64_t seed) {
  Random random(seed, "plan");
  std::array<double, kPresses> depths{};
  for (std::size_t i = 0; i < kPresses; ++i) {
    depths[i] = kPlaces[i].depth + random.between(-0.0005, 0.0005);
  }
  return depths;
}

bool is_at(const PressTarget& target, const Place& place, double height) {
  const double share = target.x.z() / height;
  return place.low <= share && share <= place.high && place.least_up <= target.normal.z() &&
         target.normal.z() <= place.most_up;
}

/// Score of a target: higher the nearer its direction is to the wanted one, and for presses from
/// the right.
double seen_as_asked(const PressTarget& target, const Place& place, const Vector3d& eye) {
  const double facing = target.direction.dot((eye - target.x).normalized());
  return 1.0 - 2.0 * std::abs(facing - place.facing) - 0.4 * target.direction.x();
}

/// The targets at a place that satisfy the rules, the best seen first.
std::vector<PressTarget> targets_at(const PressSearch& search,
                                    const std::vector<PressTarget>& targets, const Place& place) {
  const double height = search.points().row(2).maxCoeff();
  std::vector<PressTarget> found;
  for (const RankedTarget& ranked : search.ranked(targets, demo_rules())) {
    if (is_at(ranked.target, place, height)) found.push_back(ranked.target);
  }
  std::stable_sort(found.begin(), found.end(), [&](const PressTarget& a, const PressTarget& b) {
    return seen_as_asked(a, place, search.eye()) > seen_as_asked(b, place, search.eye());
  });
  return found;
}

/// A press with its posture and depth.
struct PlannedPress {
  PressPosture posture;
  double depth;  // m
};
std::vector<PlannedPress> find_presses(const PressSearch& search,
                                       const std::vector<PressTarget>& targets,
                                       const std::array<double, kPresses>& depths) {
  constexpr double kApart = 0.015;  // m, smallest distance between targets
  constexpr int kTried = 8;         // targets tried per place
  std::vector<PlannedPress> found;
  for (std::size_t i = 0; i < kPresses; ++i) {
    int tried = 0;
    for (const PressTarget& target : targets_at(search, targets, kPlaces[i])) {
      const bool apart = std::all_of(found.begin(), found.end(), [&](const PlannedPress& other) {
        return (other.posture.target.x - target.x).norm() > kApart;
      });
      if (!apart) continue;
      if (++tried > kTried) break;
      const auto posture = search.posture(target, depths[i], index_finger(), {}, demo_rules());
      if (!posture) continue;
      found.push_back({*posture, depths[i]});
      break;
    }
  }
  return found;
}

/// Rotations of the body, rad, sorted by how well the camera sees all places.
std::vector<double> yaws_for_demo(const DeskBody& body) {
  constexpr int kYaws = 18;
  struct Yaw {
    double value, angle;
  };
  std::vector<Yaw> yaws;
  for (int i = 0; i < kYaws; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kYaws;
    const Rigid3 turned = turned_body(angle);
    const PressSearch search(turned.linear() * body.surface.vertices, first_eye());
    const std::vector<PressTarget> targets = skin_targets(body, turned, kTargets, kLean);
    // A body is recognised best from its broad side.
    double value = 4.0 * (search.points().row(0).maxCoeff() - search.points().row(0).minCoeff()) /
                   search.points().row(2).maxCoeff();
    for (const Place& place : kPlaces) {
      const std::vector<PressTarget> list = targets_at(search, targets, place);
      if (!list.empty()) value += 1.0 + seen_as_asked(list.front(), place, first_eye());
    }
    yaws.push_back({value, angle});
  }
  std::stable_sort(yaws.begin(), yaws.end(),
                   [](const Yaw& a, const Yaw& b) { return a.value > b.value; });
  std::vector<double> angles;
  for (const Yaw& yaw : yaws) angles.push_back(yaw.angle);
  return angles;
}

/// The path of the hand through the whole clip. Times are in frames of the script, which start with
/// the first frame with a hand.
class DemoScript {
 public:
  DemoScript(const std::vector<PlannedPress>& presses, int frames, std::uint64_t seed)
      : presses_(presses), stretch_((frames - kFramesWithoutHand) / kScriptLength) {
    path_.tool = index_finger();
    path_.tremor_seed = seed;
    write();
  }

  [[nodiscard]] const HandPath& path() const { return path_; }
  [[nodiscard]] const std::vector<PlannedTouch>& touches() const { return touches_; }
  [[nodiscard]] std::vector<NamedSpan> spans() const {
    return {{"hand_in_front", whole_frames(118, 135)}, {"hand_behind", whole_frames(201, 214)}};
  }

 private:
  [[nodiscard]] double frame_at(double at) const { return kFramesWithoutHand + at * stretch_; }
  /// The frames that lie within a span of the script.
  [[nodiscard]] FrameSpan whole_frames(double first, double last) const {
    return {static_cast<int>(std::ceil(frame_at(first))),
            static_cast<int>(std::floor(frame_at(last)))};
  }

  void key(double at, const Vector3d& tip, const Quaterniond& turn, double open) {
    path_.keys.push_back({frame_at(at), tip, turn, open});
  }
  void key_knuckles(double at, const Vector3d& knuckles, const Quaterniond& turn, double open) {
    key(at, tip_for_knuckles(path_.tool, knuckles, turn), turn, open);
  }

  /// A press: straight in from `start` to `deep`, held until `hold`, straight out until `end`.
  void press(std::size_t which, double start, double deep, double hold, double end) {
    const PressPosture& p = presses_[which].posture;
    const double depth = presses_[which].depth;
    const Vector3d before = p.touch - demo_rules().approach * p.target.direction;
    const Vector3d deepest = p.touch + depth * p.target.direction;
    key(start, before, p.turn, 0.0);
    key(deep, deepest, p.turn, 0.0);
    key(hold, deepest, p.turn, 0.0);
    key(end, before, p.turn, 0.0);
    const FrameSpan frames{static_cast<int>(std::floor(frame_at(start))),
                           static_cast<int>(std::ceil(frame_at(end)))};
    touches_.push_back({"finger", p.target.site, p.target.between, depth, frames,
                        (deep - start) * stretch_ / kFramesPerSecond, p.view_angle, p.touch,
                        p.target.direction});
  }

  void write() {
    const Quaterniond left_away = resting_turn(), in_front = turn_before_camera();
    const Quaterniond behind(frame_of({-0.98, -0.10, -0.05}, {-0.05, -0.20, 0.97}));
    const Vector3d eye = first_eye();
    const Vector3d front = eye + 0.285 * (Vector3d(0.0, 0.0, 0.075) - eye).normalized();
    const Vector3d rest(0.25, 0.05, 0.14);

    key_knuckles(0, {0.62, 0.16, 0.24}, left_away, 0.6);
    key_knuckles(16, rest, left_away, 0.3);
    press(0, 26, 38, 50, 60);
    press(1, 74, 86, 97, 106);
    key_knuckles(114, front + Vector3d(0.20, 0.03, 0.0), in_front, 0.8);
    key_knuckles(122, front + Vector3d(0.035, 0.0, 0.0), in_front, 1.0);
    key_knuckles(131, front + Vector3d(0.015, 0.0, 0.005), in_front, 1.0);
    key_knuckles(142, front + Vector3d(0.21, 0.05, 0.02), in_front, 0.6);
    press(2, 156, 166, 176, 184);
    key_knuckles(195, {0.20, 0.145, 0.095}, behind, 0.8);
    key_knuckles(204, {0.035, 0.145, 0.084}, behind, 1.0);
    key_knuckles(211, {0.015, 0.145, 0.082}, behind, 1.0);
    key_knuckles(222, rest, left_away, 0.5);
    key_knuckles(kSqueezeBegins - 2, {0.62, 0.16, 0.24}, left_away, 0.6);
  }

  const std::vector<PlannedPress>& presses_;
  double stretch_;
  HandPath path_;
  std::vector<PlannedTouch> touches_;
};

/// Describes an unplanned contact: the hand touches the desk, or it touches the body outside of the
/// frames of the presses, away from their places, or deeper than planned. Empty when there is none.
std::string trouble_in(const DemoScript& script, const std::vector<PlannedPress>& presses,
                       const PressSearch& search, int frames) {
  constexpr double kDeeper = 0.0006;  // m, allowance for tremor and the spacing of vertices
  for (int frame = kFramesWithoutHand; frame < frames; ++frame) {
    const std::vector<Capsule> hand = shapes_of(script.path().capsules(frame));
    const ContactTruth truth = contact_truth(hand, search.points());
    bool planned = !truth.touching;
    for (std::size_t i = 0; !planned && i < presses.size(); ++i) {
      const PlannedTouch& touch = script.touches()[i];
      const double beside =
          (search.points().col(truth.vertex) - presses[i].posture.target.x).norm();
      planned = touch.frames.first <= frame && frame <= touch.frames.last &&
                truth.depth < touch.depth + kDeeper && beside < demo_rules().near;
    }
    if (!planned)
      return fmt::format("the hand meets the body in frame {} ({:.1f} mm deep)", frame,
                         1e3 * truth.depth);
    if (lowest_point(hand) < 0.0) return fmt::format("the hand meets the desk in frame {}", frame);
  }
  return "";
}

}  // namespace

Sequence plan_demo(const DeskBody& body, int frames, std::uint64_t seed) {
  Sequence sequence = tripod_sequence("demo", frames, seed);
  sequence.look.room = false;
  const std::array<double, kPresses> depths = demo_depths(seed);
  const double stretch = (frames - kFramesWithoutHand) / kScriptLength;
  const double squeeze_first = kFramesWithoutHand + kSqueezeBegins * stretch;

  std::string why = "no place can be pressed where the left camera sees it";
  // Plans the presses for a rotation of the body. @return whether there are enough and no trouble
  const auto attempt = [&](double yaw, std::size_t needed) {
    sequence.desk_from_body = turned_body(yaw);
    const PressSearch search(sequence.desk_from_body.linear() * body.surface.vertices, first_eye());
    std::vector<PlannedPress> presses =
        find_presses(search, skin_targets(body, sequence.desk_from_body, kTargets, kLean), depths);
    if (presses.size() < needed) return false;
    // If the body lacks some of the places, its first one is pressed again.
    while (presses.size() < kPresses) presses.push_back(presses.front());

    const DemoScript script(presses, frames, seed);
    why = trouble_in(script, presses, search, static_cast<int>(squeeze_first));
    sequence.touches = script.touches();
    sequence.spans = script.spans();
    sequence.movers = hand_alone(script.path());
    return why.empty();
  };
  // Adds a squeeze by a second hand after the first one has left the picture.
  const auto add_squeeze = [&](Sequence& to) {
    auto squeeze = plan_one_squeeze(body, to.desk_from_body, squeeze_first, stretch, seed);
    if (!squeeze) return false;
    to.touches.insert(to.touches.end(), squeeze->touches.begin(), squeeze->touches.end());
    to.movers = [first = to.movers, path = std::move(squeeze->path), squeeze_first](double frame) {
      return frame < squeeze_first ? first(frame) : Movers{path.capsules(frame), std::nullopt};
    };
    return true;
  };
  // Three presses and a squeeze if some rotation of the body allows them, otherwise as much as
  // possible: more presses are preferred to a squeeze.
  const std::vector<double> yaws = yaws_for_demo(body);
  for (const std::size_t needed : {3U, 2U, 1U}) {
    std::optional<Sequence> without_squeeze;
    int tried = 0;
    for (const double yaw : yaws) {
      if (!attempt(yaw, needed)) continue;
      if (add_squeeze(sequence)) return sequence;
      if (!without_squeeze) without_squeeze = sequence;
      if (++tried == kSqueezesTried) break;
    }
    if (without_squeeze) return *std::move(without_squeeze);
  }
  throw Error("the demo cannot be planned for this body: " + why +
              "; the body should be 0.05 to 0.25 m high, with sides that a finger reaches");
}

}  // namespace palpable
