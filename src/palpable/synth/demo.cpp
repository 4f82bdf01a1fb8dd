#include "palpable/base/contract.h"
#include "palpable/base/error.h"
#include "palpable/synth/camera_motions.h"
#include "palpable/synth/contact_truth.h"
#include "palpable/synth/press_targets.h"
#include "palpable/synth/presses.h"
#include "palpable/synth/random.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace palpable {

namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kDegree = std::numbers::pi / 180.0;

/// The motion is written for this many frames with a hand and stretched to what is asked for.
constexpr double kScriptLength = 240.0;

/// The touching surface must face the eye within 70 degrees; two are kept in reserve. Less than 30
/// would be a press along the line of sight, which is another sequence.
PressRules demo_rules() {
  PressRules rules;
  rules.least_facing = std::cos(68.0 * kDegree);
  rules.most_facing = std::cos(30.0 * kDegree);
  rules.most_x = -0.25;
  rules.eye_clearance = 0.0;
  return rules;
}

struct Ranked {
  PressTarget target;
  double score;
};

std::vector<Ranked> ranked_sites(const DeskBody& body, const PressSearch& search, double yaw) {
  std::vector<Ranked> ranked;
  for (const PressTarget& target : site_targets(body, turned_body(yaw)))
    if (const double score = search.score(target, demo_rules()); score > 0.0)
      ranked.push_back({target, score});
  std::stable_sort(ranked.begin(), ranked.end(),
                   [](const Ranked& a, const Ranked& b) { return a.score > b.score; });
  return ranked;
}

PressSearch search_at(const DeskBody& body, double yaw) {
  return {turned_body(yaw).linear() * body.surface.vertices, first_eye()};
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
  const HandTool finger = index_finger();
  const Vector3d eye = first_eye();

  Random random(seed, "plan");
  const std::array<double, 3> depths = {0.008 + random.between(-0.001, 0.001),
                                        0.0055 + random.between(-0.0005, 0.001),
                                        0.0115 + random.between(-0.001, 0.0005)};
  // How the body is turned: the yaw with the best sites.
  std::vector<std::pair<double, double>> yaws;  // (value, yaw)
  for (int i = 0; i < 36; ++i) {
    const double yaw = 10.0 * i * kDegree;
    const std::vector<Ranked> ranked = ranked_sites(body, search_at(body, yaw), yaw);
    double value = 0.0;
    for (std::size_t s = 0; s < std::min<std::size_t>(5, ranked.size()); ++s)
      value += ranked[s].score;
    yaws.emplace_back(value, yaw);
  }
  std::stable_sort(yaws.begin(), yaws.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });

  std::string why = "no site can be pressed where the left camera sees it";
  const auto attempt = [&](double yaw, std::size_t needed) {
    const PressSearch search = search_at(body, yaw);
    sequence.desk_from_body = turned_body(yaw);
    std::vector<PressPosture> found;
    for (const Ranked& ranked : ranked_sites(body, search, yaw)) {
      if (found.size() == 3) break;
      // Presses are spread over the body where it has enough sites.
      bool apart = true;
      for (const PressPosture& other : found)
        apart = apart && (other.target.x - ranked.target.x).norm() > 0.015;
      if (!apart) continue;
      const auto posture =
          search.posture(ranked.target, depths[found.size()], finger, {}, demo_rules());
      if (posture) found.push_back(*posture);
    }
    if (found.size() < needed) return false;
    // A body with few sites is pressed at one of them again.
    while (found.size() < 3) found.push_back(found.front());

    // The script. Tips and wrists in the desk frame; the hand is open where it only passes.
    const auto wrist_turn = [](const Vector3d& fingers, const Vector3d& back) {
      return Quaterniond(frame_of(fingers, back));
    };
    const auto palm_at = [&](const Vector3d& knuckles, const Quaterniond& turn) {
      // The tip of the open index finger when the palm's knuckles are at this place.
      return Vector3d(knuckles +
                      turn * (tip_in_wrist(finger, finger.passing) - Vector3d(0.08, 0.0, 0.0)));
    };
    const double stretch = (frames - kFramesWithoutHand) / kScriptLength;
    const auto script = [&](double at) { return kFramesWithoutHand + at * stretch; };
    HandPath path{finger, {}, {}, seed};
    sequence.touches.clear();
    const auto key = [&](double at, const Vector3d& tip, const Quaterniond& turn, double opened) {
      path.keys.push_back({script(at), tip, turn, opened});
    };
    const double approach = demo_rules().approach;
    const auto press = [&](std::size_t which, double start, double deep, double hold, double end) {
      const PressPosture& p = found[which];
      const Vector3d before = p.touch - approach * p.target.direction;
      const Vector3d deepest = p.touch + depths[which] * p.target.direction;
      key(start, before, p.turn, 0.0);
      key(deep, deepest, p.turn, 0.0);
      key(hold, deepest, p.turn, 0.0);
      key(end, before, p.turn, 0.0);
      sequence.touches.push_back(
          {"finger",
           p.target.site,
           false,
           depths[which],
           {static_cast<int>(std::floor(script(start))), static_cast<int>(std::ceil(script(end)))},
           (deep - start) * stretch / kFramesPerSecond,
           p.view_angle,
           p.touch,
           p.target.direction});
    };
    const Quaterniond left_away = wrist_turn({-0.93, -0.20, -0.25}, {-0.15, -0.30, 0.94});
    const Quaterniond front_turn = wrist_turn({-0.95, 0.16, -0.12}, {-0.10, -0.55, 0.83});
    const Quaterniond behind_turn = wrist_turn({-0.98, -0.10, -0.05}, {-0.05, -0.20, 0.97});
    const Vector3d to_body = (Vector3d(0.0, 0.0, 0.075) - eye).normalized();
    const Vector3d front = eye + 0.285 * to_body;
    const Vector3d rest = palm_at({0.25, 0.05, 0.14}, left_away);

    key(0, palm_at({0.62, 0.16, 0.24}, left_away), left_away, 0.6);
    key(18, rest, left_away, 0.3);
    press(0, 28, 42, 54, 65);
    key(77, palm_at(front + Vector3d(0.20, 0.03, 0.0), front_turn), front_turn, 0.8);
    key(90, palm_at(front + Vector3d(0.035, 0.0, 0.0), front_turn), front_turn, 1.0);
    key(99, palm_at(front + Vector3d(0.015, 0.0, 0.005), front_turn), front_turn, 1.0);
    key(110, palm_at(front + Vector3d(0.21, 0.05, 0.02), front_turn), front_turn, 0.6);
    press(1, 122, 128, 136, 143);
    key(152, rest, left_away, 0.5);
    key(163, palm_at({0.20, 0.145, 0.095}, behind_turn), behind_turn, 0.8);
    key(172, palm_at({0.035, 0.145, 0.084}, behind_turn), behind_turn, 1.0);
    key(179, palm_at({0.015, 0.145, 0.082}, behind_turn), behind_turn, 1.0);
    key(190, rest, left_away, 0.5);
    press(2, 201, 213, 221, 229);
    key(kScriptLength, rest, left_away, 0.4);
    const auto span = [&](double first, double last) {
      return FrameSpan{static_cast<int>(std::ceil(script(first))),
                       static_cast<int>(std::floor(script(last)))};
    };
    sequence.spans = {{"hand_in_front", span(86, 103)}, {"hand_behind", span(169, 182)}};

    // Every frame, all vertices: touched in the presses, at their places, and nowhere else.
    why.clear();
    for (int frame = kFramesWithoutHand; frame < frames && why.empty(); ++frame) {
      const std::vector<Capsule> hand = shapes_of(path.capsules(frame));
      if (lowest_point(hand) < 0.0) why = fmt::format("the hand meets the desk in frame {}", frame);
      const ContactTruth truth = contact_truth(hand, search.points());
      if (!truth.touching) continue;
      bool planned = false;
      for (std::size_t i = 0; i < sequence.touches.size(); ++i) {
        const PlannedTouch& p = sequence.touches[i];
        planned =
            planned ||
            (p.frames.first <= frame && frame <= p.frames.last && truth.depth < p.depth + 0.0006 &&
             (search.points().col(truth.vertex) - found[i].target.x).norm() < demo_rules().near);
      }
      if (!planned)
        why = fmt::format("the hand meets the body in frame {} ({:.1f} mm deep)", frame,
                          1e3 * truth.depth);
    }
    sequence.movers = [path](double frame) {
      return frame < kFramesWithoutHand ? Movers{} : Movers{path.capsules(frame), std::nullopt};
    };
    return why.empty();
  };
  // Three different sites if any way of turning the body allows it.
  for (const std::size_t needed : {3U, 2U, 1U})
    for (const auto& [value, yaw] : yaws)
      if (value > 0.0 && attempt(yaw, needed)) return sequence;
  throw Error("the demo cannot be planned for this body: " + why +
              "; the body should be 0.05 to 0.25 m high and have sites on several sides");
}

}  // namespace palpable
