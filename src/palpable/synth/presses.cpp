#include "palpable/synth/presses.h"

#include "palpable/base/contract.h"
#include "palpable/base/error.h"
#include "palpable/synth/camera_motions.h"
#include "palpable/synth/contact_truth.h"
#include "palpable/synth/press_targets.h"
#include "palpable/synth/random.h"
#include "palpable/synth/things.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

namespace palpable {

namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kPointSpacing = 0.0015;  // m: a pencil's tip is 1.2 mm in radius

/// How one kind of sequence presses.
struct Style {
  std::string what = "finger";
  HandTool tool = index_finger();
  ArmSide arm;
  PressRules rules;
  double least_depth = 0.003, most_depth = 0.014;  // m
  bool slides = false;
  bool comes_near = false;  ///< passes close before the camera now and then
  bool two_hands = false;
};

/// The touching surface faces the eye within 70 degrees (two are kept in reserve) and the press is
/// not along the line of sight.
PressRules rules_where_seen() {
  PressRules rules;
  rules.least_facing = std::cos(68.0 * kDegree);
  rules.most_facing = std::cos(30.0 * kDegree);
  rules.most_x = -0.20;
  return rules;
}

Style style_of(std::string_view name) {
  Style style;
  style.rules = rules_where_seen();
  if (name == "press") {
    style.comes_near = true;
  } else if (name == "pencil") {
    style.what = "pencil";
    style.tool = hand_with_pencil();
    style.most_depth = 0.010;
  } else if (name == "slide") {
    style.what = "slide";
    style.slides = true;
    style.least_depth = 0.003;
    style.most_depth = 0.006;
  } else if (name == "palm") {
    style.what = "palm";
    style.tool = flat_hand();
    style.least_depth = 0.004;
    style.most_depth = 0.009;
    style.rules.least_facing = -0.7;
    style.rules.most_facing = 1.0;
    style.rules.seen = false;
    style.rules.near = 0.11;
    style.rules.clearance = 0.0;
  } else if (name == "two-hands") {
    style.two_hands = true;
  } else if (name == "press-axial") {
    style.arm = {{0.85, -0.45, 0.25}, {0.85, -0.30, 0.40}};
    style.rules.least_facing = -1.0;
    style.rules.most_facing = -std::cos(32.0 * kDegree);
    style.rules.most_x = 1.0;
    style.rules.seen = false;
    style.rules.eye_clearance = 0.06;
  } else {
    PALPABLE_EXPECT(name == "press-behind", "the sequence is one of those with presses");
    style.rules.least_facing = std::cos(40.0 * kDegree);
    style.rules.most_facing = 1.0;
    style.rules.most_x = 0.30;
  }
  return style;
}

/// The index finger's tip when the knuckles of the passing hand are at a place.
Vector3d tip_for_knuckles(const HandTool& tool, const Vector3d& knuckles, const Quaterniond& turn) {
  return knuckles + turn * (tip_in_wrist(tool, tool.passing) - Vector3d(0.08, 0.0, 0.0));
}

/// A hand that comes in, presses, goes back to its rest, and so on.
class HandScript {
 public:
  HandScript(const PressSearch& search, const SurfacePoints& surface, const Style& style,
             std::uint64_t seed)
      : search_(search), surface_(surface), style_(style) {
    path_.tool = style.tool;
    path_.arm = style.arm;
    path_.tremor_seed = seed;
    rest_ = tip_for_knuckles(style.tool, {0.25, 0.05, 0.14}, rest_turn_);
    key(0, tip_for_knuckles(style.tool, {0.62, 0.16, 0.24}, rest_turn_), rest_turn_, 0.6);
    key(18, rest_, rest_turn_, 0.5);
  }

  [[nodiscard]] double now() const { return path_.keys.back().frame; }
  [[nodiscard]] const HandPath& path() const { return path_; }
  [[nodiscard]] const std::vector<PlannedTouch>& touches() const { return touches_; }
  [[nodiscard]] const std::vector<NamedSpan>& spans() const { return spans_; }
  [[nodiscard]] const std::string& why_not() const { return why_not_; }

  /// How long the hand takes: frames of the way in, at the depth, and out.
  struct Pace {
    double in, hold, out;
  };

  /// Adds a press and the way back to the rest; nothing, and false, when that meets the body where
  /// it should not.
  bool press(const PressPosture& p, double depth, const Pace& pace) {
    const Vector3d before = p.touch - style_.rules.approach * p.target.direction;
    const Vector3d deepest = p.touch + depth * p.target.direction;
    return touch(p, depth, pace, before, {deepest, deepest}, pace.hold);
  }

  /// Touches at one target and slides along the surface to another.
  bool slide(const PressPosture& from, const PressTarget& to, double depth, const Pace& pace) {
    std::vector<Vector3d> way;
    constexpr int kParts = 12;
    for (int i = 0; i <= kParts; ++i) {
      const double t = static_cast<double>(i) / kParts;
      const Vector3d x = from.target.x + t * (to.x - from.target.x);
      const Vector3d d =
          (from.target.direction + t * (to.direction - from.target.direction)).normalized();
      const auto place = search_.first_touch(x, d, from.turn, style_.tool, style_.arm);
      if (!place) return false;
      way.push_back(*place + depth * d);
      // On a fold the surface jumps, and the finger cannot follow.
      if (i > 0 && (way[way.size() - 1] - way[way.size() - 2]).norm() > 0.012) return false;
    }
    const Vector3d before = from.touch - style_.rules.approach * from.target.direction;
    return touch(from, depth, pace, before, way, pace.hold);
  }

  /// Close before the lens: a pointing finger in the middle of the picture, 0.09 m away.
  void pass_the_lens(double frames) {
    const Quaterniond turn(frame_of({-0.95, 0.16, -0.12}, {-0.10, -0.55, 0.83}));
    const Rigid3 desk_from_camera = first_camera_from_desk().inverse();
    const auto at = [&](double x, double y, double z) -> Vector3d {
      return desk_from_camera * Vector3d(x, y, z);
    };
    const double start = now();
    key(start + 16, at(0.13, 0.055, 0.15), turn, 0.2);
    key(start + 24, at(0.012, 0.030, 0.098), turn, 0.1);
    key(start + 24 + 0.5 * frames, at(-0.012, 0.020, 0.092), turn, 0.0);
    key(start + 24 + frames, at(0.005, 0.035, 0.100), turn, 0.15);
    key(start + 34 + frames, at(0.15, 0.060, 0.17), turn, 0.4);
    key(start + 50 + frames, rest_, rest_turn_, 0.5);
    spans_.push_back({"hand_near", {to_frame(start + 24), to_frame(start + 24 + frames)}});
  }

  /// An open hand at work a hand's length before the camera.
  void work_in_front(double frames) {
    const Quaterniond turn(frame_of({-0.95, 0.16, -0.12}, {-0.10, -0.55, 0.83}));
    const Quaterniond other(frame_of({-0.86, 0.30, 0.35}, {-0.30, -0.75, 0.60}));
    const Rigid3 desk_from_camera = first_camera_from_desk().inverse();
    const auto at = [&](double x, double y, double z, const Quaterniond& how) {
      return tip_for_knuckles(style_.tool, desk_from_camera * Vector3d(x, y, z), how);
    };
    const double start = now();
    key(start + 16, at(0.24, 0.03, 0.26, turn), turn, 0.8);
    key(start + 26, at(0.09, 0.02, 0.22, turn), turn, 1.0);
    key(start + 26 + 0.35 * frames, at(0.05, -0.01, 0.17, other), other, 0.6);
    key(start + 26 + 0.65 * frames, at(0.06, 0.03, 0.15, turn), turn, 0.9);
    key(start + 26 + frames, at(0.10, 0.01, 0.21, turn), turn, 1.0);
    key(start + 38 + frames, at(0.25, 0.05, 0.27, turn), turn, 0.7);
    key(start + 54 + frames, rest_, rest_turn_, 0.5);
    spans_.push_back({"hand_in_front", {to_frame(start + 26), to_frame(start + 26 + frames)}});
  }

  void wait(double frames) { key(now() + frames, rest_, rest_turn_, 0.5); }

 private:
  static int to_frame(double at) { return static_cast<int>(std::lround(at)); }

  void key(double at, const Vector3d& tip, const Quaterniond& turn, double open) {
    // The first key's time counts from the first frame with a hand.
    const double start = path_.keys.size() < 2 ? kFramesWithoutHand : 0.0;
    path_.keys.push_back({start + at, tip, turn, open});
  }

  bool touch(const PressPosture& p, double depth, const Pace& pace, const Vector3d& before,
             const std::vector<Vector3d>& places, double hold) {
    const std::size_t keys_before = path_.keys.size();
    const double start = now();
    const double first = start + 14;
    key(first, before, p.turn, 0.0);
    for (std::size_t i = 0; i < places.size(); ++i)
      key(first + pace.in + hold * static_cast<double>(i) / static_cast<double>(places.size() - 1),
          places[i], p.turn, 0.0);
    const Vector3d away = places.back() - places.front() + before;
    key(first + pace.in + hold + pace.out, away, p.turn, 0.0);
    key(first + pace.in + hold + pace.out + 14, rest_, rest_turn_, 0.5);
    const FrameSpan frames{static_cast<int>(std::floor(first)),
                           static_cast<int>(std::ceil(first + pace.in + hold + pace.out))};
    if (!touches_only(p, places, frames, start)) {
      path_.keys.resize(keys_before);
      return false;
    }
    touches_.push_back({style_.what, p.target.site, p.target.between, depth, frames,
                        pace.in / kFramesPerSecond, p.view_angle, p.touch, p.target.direction});
    return true;
  }

  /// Every frame since `start`: touched in `frames`, near the planned places, and nowhere else.
  bool touches_only(const PressPosture& p, const std::vector<Vector3d>& places, FrameSpan frames,
                    double start) {
    bool touched = false;
    for (int frame = static_cast<int>(std::ceil(start)); frame <= std::floor(now()); ++frame) {
      const std::vector<Capsule> hand = shapes_of(path_.capsules(frame));
      if (lowest_point(hand) < 0.0) {
        why_not_ = "the hand would meet the desk";
        return false;
      }
      const PressTruth truth = press_truth(hand, surface_);
      if (!truth.touching) continue;
      const Vector3d x = surface_.points.col(truth.point);
      double nearest = (x - p.target.x).norm();
      for (const Vector3d& place : places) nearest = std::min(nearest, (x - place).norm());
      if (frame < frames.first || frame > frames.last || nearest > style_.rules.near) {
        why_not_ = fmt::format("the hand would meet the body {:.0f} mm beside the planned place",
                               1e3 * nearest);
        return false;
      }
      touched = true;
    }
    if (!touched) why_not_ = "the press would not touch";
    return touched;
  }

  const PressSearch& search_;
  const SurfacePoints& surface_;  // what search_ looks at
  const Style& style_;
  Quaterniond rest_turn_{frame_of({-0.93, -0.20, -0.25}, {-0.15, -0.30, 0.94})};
  Vector3d rest_;
  HandPath path_;
  std::vector<PlannedTouch> touches_;
  std::vector<NamedSpan> spans_;
  std::string why_not_ = "no place can be pressed as this sequence presses";
};

struct Ranked {
  PressTarget target;
  double score;
};

std::vector<Ranked> ranked(const std::vector<PressTarget>& targets, const PressSearch& search,
                           const PressRules& rules) {
  std::vector<Ranked> list;
  for (const PressTarget& target : targets)
    if (const double score = search.score(target, rules); score > 0.0)
      list.push_back({target, score});
  std::stable_sort(list.begin(), list.end(),
                   [](const Ranked& a, const Ranked& b) { return a.score > b.score; });
  return list;
}

/// The world in a mirror, where the left hand is a right one.
PressSearch mirror_image(const PressSearch& search) {
  const Vector3d flip(-1, 1, 1);
  return {flip.asDiagonal() * search.points(), flip.asDiagonal() * search.eye()};
}
SurfacePoints mirror_image(const SurfacePoints& surface) {
  const Vector3d flip(-1, 1, 1);
  return {flip.asDiagonal() * surface.points, flip.asDiagonal() * surface.inwards};
}
std::vector<PressTarget> mirror_image(std::vector<PressTarget> targets) {
  for (PressTarget& t : targets)
    for (Vector3d* v : {&t.x, &t.direction, &t.normal}) v->x() = -v->x();
  return targets;
}

/// Several speeds: from a quick tap to a slow push, in an order that the seed turns.
HandScript::Pace pace_of(int press, Random& random, bool slides) {
  constexpr std::array<double, 5> kIn = {14, 7, 20, 10, 30};
  const double in = kIn[static_cast<std::size_t>(press) % kIn.size()] + random.between(-1, 1);
  const double hold = slides ? random.between(20, 45) : random.between(4, 14);
  return {in, hold, std::max(7.0, 0.75 * in)};
}

/// Fills a hand's time with presses. False when not one was found.
bool fill(HandScript& script, const PressSearch& search, const std::vector<PressTarget>& sites,
          const std::vector<PressTarget>& between, const Style& style, int frames, Random& random) {
  struct Way {
    PressPosture posture;
    PressTarget end;  // of a slide
    double depth;
  };
  std::array<std::vector<Ranked>, 2> lists = {ranked(sites, search, style.rules),
                                              ranked(between, search, style.rules)};
  std::array<std::size_t, 2> next = {0, 0};
  std::vector<Way> ways;
  // Depths spread evenly over the range, wherever the seed begins.
  double share = random.unit();
  const auto next_depth = [&] {
    share = std::fmod(share + std::numbers::phi - 1.0, 1.0);
    return style.least_depth + share * (style.most_depth - style.least_depth);
  };
  // Sites and places between them take turns; the seed says which begins.
  const std::size_t begins = random.unit() < 0.5 ? 0 : 1;
  // The next target that works; tried in order of how well it is seen.
  const auto find = [&](int press, double depth) {
    const std::size_t kind = (begins + static_cast<std::size_t>(press)) % 2;
    for (const std::size_t k : {kind, 1 - kind}) {
      while (next[k] < lists[k].size()) {
        const PressTarget target = lists[k][next[k]++].target;
        bool apart = true;
        for (const Way& way : ways)
          apart = apart && (way.posture.target.x - target.x).norm() > 0.012;
        if (!apart) continue;
        const auto posture = search.posture(target, depth, style.tool, style.arm, style.rules);
        if (!posture) continue;
        const auto pace = pace_of(press, random, style.slides);
        if (!style.slides) {
          if (!script.press(*posture, depth, pace)) continue;
          ways.push_back({*posture, {}, depth});
          return true;
        }
        for (const auto& list : lists)
          for (const Ranked& end : list) {
            const double way = (end.target.x - target.x).norm();
            if (way < 0.025 || way > 0.07) continue;
            if (!script.slide(*posture, end.target, depth, pace)) continue;
            ways.push_back({*posture, end.target, depth});
            return true;
          }
      }
    }
    return false;
  };

  constexpr std::size_t kDifferent = 6;
  for (int press = 0; script.now() < frames; ++press) {
    const double depth = next_depth();
    if (ways.size() >= kDifferent || !find(press, depth)) {
      if (ways.empty()) return false;
      // Again, not deeper than it was planned for.
      const Way& way = ways[static_cast<std::size_t>(press) % ways.size()];
      const auto pace = pace_of(press, random, style.slides);
      const double again = std::min(depth, way.depth);
      const bool done = style.slides ? script.slide(way.posture, way.end, again, pace)
                                     : script.press(way.posture, again, pace);
      if (!done) script.wait(20);
    }
    if (!style.comes_near) script.wait(random.between(4, 14));
    if (style.comes_near && press % 4 == 0) script.pass_the_lens(34);
    if (style.comes_near && press % 4 == 2) script.work_in_front(44);
  }
  return true;
}

/// The smallest gap between two hands, m: each end of a capsule against the other's surface.
double gap(const std::vector<Capsule>& first, const std::vector<Capsule>& second) {
  double least = 1.0;
  for (const Capsule& c : first)
    least =
        std::min({least, signed_distance(second, c.a) - c.ra, signed_distance(second, c.b) - c.rb,
                  signed_distance(second, 0.5 * (c.a + c.b)) - 0.5 * (c.ra + c.rb)});
  return least;
}

}  // namespace

Sequence plan_presses(std::string_view name, const DeskBody& body, int frames, std::uint64_t seed) {
  const Style style = style_of(name);
  const SurfacePoints surface = sample_surface(body.surface, kPointSpacing);

  // How the body is turned: best first; the seed begins with another of the four best.
  struct Yaw {
    double value, angle;
  };
  std::vector<Yaw> yaws;
  for (int i = 0; i < 36; ++i) {
    const double angle = 10.0 * i * kDegree;
    const Rigid3 turned = turned_body(angle);
    const PressSearch search(turned.linear() * body.surface.vertices, first_eye());
    const auto value_of = [&](const PressSearch& world, const std::vector<PressTarget>& targets) {
      const std::vector<Ranked> list = ranked(targets, world, style.rules);
      double value = 0.0;
      for (std::size_t s = 0; s < std::min<std::size_t>(6, list.size()); ++s)
        value += list[s].score;
      return value;
    };
    const std::vector<PressTarget> targets = site_targets(body, turned);
    double value = value_of(search, targets);
    if (style.two_hands)
      value = std::min(value, value_of(mirror_image(search), mirror_image(targets)));
    if (value > 0.0) yaws.push_back({value, angle});
  }
  std::stable_sort(yaws.begin(), yaws.end(),
                   [](const Yaw& a, const Yaw& b) { return a.value > b.value; });
  if (yaws.size() >= 4) std::rotate(yaws.begin(), yaws.begin() + seed % 4, yaws.begin() + 4);

  std::string why = "no site is where this sequence can press it";
  for (const Yaw& yaw : yaws) {
    const Rigid3 desk_from_body = turned_body(yaw.angle);
    const SurfacePoints in_desk = transformed(surface, desk_from_body);
    const PressSearch search(in_desk.points, first_eye());
    const std::vector<PressTarget> sites = site_targets(body, desk_from_body);
    const std::vector<PressTarget> between = between_targets(body, desk_from_body);
    Random random(seed, name);
    HandScript right(search, in_desk, style, seed);
    const bool found = fill(right, search, sites, between, style, frames, random);
    why = right.why_not();
    if (!found) continue;

    Sequence sequence;
    sequence.name = name;
    sequence.seed = seed;
    sequence.frames = frames;
    sequence.camera_from_desk = on_tripod();
    sequence.rig = [](int) { return RigState{}; };
    sequence.desk_from_body = desk_from_body;
    sequence.look.left_free = style.two_hands;
    sequence.touches = right.touches();
    sequence.spans = right.spans();
    std::vector<HandPath> paths = {right.path()};
    if (style.two_hands) {
      const PressSearch mirror = mirror_image(search);
      const SurfacePoints mirrored_surface = mirror_image(in_desk);
      HandScript left(mirror, mirrored_surface, style, seed + 1);
      if (!fill(left, mirror, mirror_image(sites), mirror_image(between), style, frames, random)) {
        why = left.why_not();
        continue;
      }
      for (PlannedTouch touch : left.touches()) {
        touch.first_touch.x() = -touch.first_touch.x();
        touch.direction.x() = -touch.direction.x();
        sequence.touches.push_back(touch);
      }
      paths.push_back(left.path());
    }
    sequence.movers = [paths](double frame) {
      Movers movers;
      if (frame < kFramesWithoutHand) return movers;
      for (std::size_t i = 0; i < paths.size(); ++i) {
        std::vector<HandCapsule> hand = paths[i].capsules(frame);
        if (i == 1) hand = mirrored(std::move(hand));
        movers.capsules.insert(movers.capsules.end(), hand.begin(), hand.end());
      }
      return movers;
    };
    bool apart = true;
    for (int frame = kFramesWithoutHand; style.two_hands && frame < frames && apart; frame += 2)
      apart = gap(shapes_of(paths[0].capsules(frame)),
                  shapes_of(mirrored(paths[1].capsules(frame)))) > 0.0;
    if (!apart) {
      why = "the two hands would meet";
      continue;
    }
    std::erase_if(sequence.touches,
                  [&](const PlannedTouch& t) { return t.frames.first >= frames; });
    std::erase_if(sequence.spans, [&](const NamedSpan& s) { return s.frames.first >= frames; });
    return sequence;
  }
  throw Error(
      fmt::format("the sequence '{}' cannot be planned for this body: {}; the body should be "
                  "0.05 to 0.25 m high and have sites on several sides",
                  name, why));
}

}  // namespace palpable
