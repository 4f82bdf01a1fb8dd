#include "palpable/script/demo.h"

#include "palpable/base/error.h"
#include "palpable/script/camera_motions.h"
#include "palpable/script/contact_truth.h"
#include "palpable/script/hand_script.h"
#include "palpable/script/press_style.h"
#include "palpable/script/press_targets.h"
#include "palpable/script/random.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace palpable {

namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

/// The motion is written for this many frames with a hand and stretched to what is asked for.
constexpr double kScriptLength = 240.0;
constexpr std::size_t kPresses = 3;

PressRules demo_rules() {
  PressRules rules = rules_where_seen();
  rules.most_x = -0.25;
  rules.eye_clearance = 0.0;
  return rules;
}

std::array<double, kPresses> demo_depths(std::uint64_t seed) {
  Random random(seed, "plan");
  return {0.008 + random.between(-0.001, 0.001), 0.0055 + random.between(-0.0005, 0.001),
          0.0115 + random.between(-0.001, 0.0005)};
}

/// Postures for the best targets that can be pressed, at most kPresses, spread over the body.
std::vector<PressPosture> find_postures(const PressSearch& search,
                                        const std::vector<PressTarget>& targets,
                                        const std::array<double, kPresses>& depths) {
  constexpr double kApart = 0.015;  // m between targets
  std::vector<PressPosture> found;
  for (const RankedTarget& ranked : search.ranked(targets, demo_rules())) {
    if (found.size() == kPresses) break;
    const bool apart = std::all_of(found.begin(), found.end(), [&](const PressPosture& other) {
      return (other.target.x - ranked.target.x).norm() > kApart;
    });
    if (!apart) continue;
    const auto posture =
        search.posture(ranked.target, depths[found.size()], index_finger(), {}, demo_rules());
    if (posture) found.push_back(*posture);
  }
  return found;
}

/// The hand's way through the whole clip. Moments are written in frames of the script, 0 being the
/// first frame with a hand.
class DemoScript {
 public:
  DemoScript(const std::vector<PressPosture>& postures, const std::array<double, kPresses>& depths,
             int frames, std::uint64_t seed)
      : postures_(postures),
        depths_(depths),
        stretch_((frames - kFramesWithoutHand) / kScriptLength) {
    path_.tool = index_finger();
    path_.tremor_seed = seed;
    write();
  }

  [[nodiscard]] const HandPath& path() const { return path_; }
  [[nodiscard]] const std::vector<PlannedTouch>& touches() const { return touches_; }
  [[nodiscard]] std::vector<NamedSpan> spans() const {
    return {{"hand_in_front", whole_frames(86, 103)}, {"hand_behind", whole_frames(169, 182)}};
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

  /// Straight in from `start` to `deep`, held until `hold`, straight out until `end`.
  void press(std::size_t which, double start, double deep, double hold, double end) {
    const PressPosture& p = postures_[which];
    const Vector3d before = p.touch - demo_rules().approach * p.target.direction;
    const Vector3d deepest = p.touch + depths_[which] * p.target.direction;
    key(start, before, p.turn, 0.0);
    key(deep, deepest, p.turn, 0.0);
    key(hold, deepest, p.turn, 0.0);
    key(end, before, p.turn, 0.0);
    const FrameSpan frames{static_cast<int>(std::floor(frame_at(start))),
                           static_cast<int>(std::ceil(frame_at(end)))};
    touches_.push_back({"finger", p.target.site, false, depths_[which], frames,
                        (deep - start) * stretch_ / kFramesPerSecond, p.view_angle, p.touch,
                        p.target.direction});
  }

  void write() {
    const Quaterniond left_away(frame_of({-0.93, -0.20, -0.25}, {-0.15, -0.30, 0.94}));
    const Quaterniond in_front(frame_of({-0.95, 0.16, -0.12}, {-0.10, -0.55, 0.83}));
    const Quaterniond behind(frame_of({-0.98, -0.10, -0.05}, {-0.05, -0.20, 0.97}));
    const Vector3d eye = first_eye();
    const Vector3d front = eye + 0.285 * (Vector3d(0.0, 0.0, 0.075) - eye).normalized();
    const Vector3d rest(0.25, 0.05, 0.14);

    key_knuckles(0, {0.62, 0.16, 0.24}, left_away, 0.6);
    key_knuckles(18, rest, left_away, 0.3);
    press(0, 28, 42, 54, 65);
    key_knuckles(77, front + Vector3d(0.20, 0.03, 0.0), in_front, 0.8);
    key_knuckles(90, front + Vector3d(0.035, 0.0, 0.0), in_front, 1.0);
    key_knuckles(99, front + Vector3d(0.015, 0.0, 0.005), in_front, 1.0);
    key_knuckles(110, front + Vector3d(0.21, 0.05, 0.02), in_front, 0.6);
    press(1, 122, 128, 136, 143);
    key_knuckles(152, rest, left_away, 0.5);
    key_knuckles(163, {0.20, 0.145, 0.095}, behind, 0.8);
    key_knuckles(172, {0.035, 0.145, 0.084}, behind, 1.0);
    key_knuckles(179, {0.015, 0.145, 0.082}, behind, 1.0);
    key_knuckles(190, rest, left_away, 0.5);
    press(2, 201, 213, 221, 229);
    key_knuckles(kScriptLength, rest, left_away, 0.4);
  }

  const std::vector<PressPosture>& postures_;
  const std::array<double, kPresses>& depths_;
  double stretch_;
  HandPath path_;
  std::vector<PlannedTouch> touches_;
};

/// What goes wrong in some frame: the hand meets the desk, or the body outside of the presses,
/// beside their places or deeper than planned. Empty when nothing does.
std::string trouble_in(const DemoScript& script, const std::vector<PressPosture>& postures,
                       const PressSearch& search, int frames) {
  constexpr double kDeeper = 0.0006;  // m, of tremor and of vertices that are apart
  for (int frame = kFramesWithoutHand; frame < frames; ++frame) {
    const std::vector<Capsule> hand = shapes_of(script.path().capsules(frame));
    const ContactTruth truth = contact_truth(hand, search.points());
    bool planned = !truth.touching;
    for (std::size_t i = 0; !planned && i < postures.size(); ++i) {
      const PlannedTouch& touch = script.touches()[i];
      const double beside = (search.points().col(truth.vertex) - postures[i].target.x).norm();
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
  Sequence sequence;
  sequence.name = "demo";
  sequence.seed = seed;
  sequence.frames = frames;
  sequence.look.room = false;
  sequence.camera_from_desk = on_tripod();
  sequence.rig = [](int) { return RigState{}; };
  const std::array<double, kPresses> depths = demo_depths(seed);

  std::string why = "no site can be pressed where the left camera sees it";
  const auto attempt = [&](double yaw, std::size_t needed) {
    sequence.desk_from_body = turned_body(yaw);
    const PressSearch search(sequence.desk_from_body.linear() * body.surface.vertices, first_eye());
    std::vector<PressPosture> postures =
        find_postures(search, site_targets(body, sequence.desk_from_body), depths);
    if (postures.size() < needed) return false;
    // A body with few sites is pressed at one of them again.
    while (postures.size() < kPresses) postures.push_back(postures.front());

    const DemoScript script(postures, depths, frames, seed);
    why = trouble_in(script, postures, search, frames);
    sequence.touches = script.touches();
    sequence.spans = script.spans();
    sequence.movers = [path = script.path()](double frame) {
      return frame < kFramesWithoutHand ? Movers{} : Movers{path.capsules(frame), std::nullopt};
    };
    return why.empty();
  };
  // Three different sites if the body turned in any way allows it.
  const std::vector<double> yaws = yaws_to_press(body, demo_rules(), 5, false);
  for (const std::size_t needed : {3U, 2U, 1U})
    for (const double yaw : yaws)
      if (attempt(yaw, needed)) return sequence;
  throw Error("the demo cannot be planned for this body: " + why +
              "; the body should be 0.05 to 0.25 m high and have sites on several sides");
}

}  // namespace palpable
