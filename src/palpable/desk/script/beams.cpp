#include "palpable/desk/script/beams.h"

#include "palpable/common/base/error.h"
#include "palpable/desk/script/camera_motions.h"
#include "palpable/desk/script/contact_truth.h"
#include "palpable/desk/script/hand_path.h"
#include "palpable/desk/script/hand_script.h"
#include "palpable/desk/script/random.h"

#include <Eigen/Geometry>
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <vector>

namespace palpable {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kBeamSpacing = 0.003;  // m, spacing of sample points on the beams' surfaces
constexpr double kAround = 0.040;  // m, radius round the pressed point in which the hand may touch
constexpr double kApproach = 0.050;  // m, height above the beam at which a press begins
// Pressed sites: distance from the support, ratio to the beam's length.
constexpr double kInner = 0.70, kOuter = 0.93;
// Pressed sites: largest distance from the middle line, ratio to the beam's width.
constexpr double kBeside = 0.28;
// Inclinations of the finger against the vertical, towards the free end, rad, in order of
// preference.
constexpr std::array kTilts{0.55, 0.70, 0.40, 0.85};

// The two beams on the desk.
struct Stack {
  std::size_t upper = 0, lower = 0;
  Rigid3 desk_from_scene = Rigid3::Identity();
  double gap = 0;                // m, between the beams
  Eigen::AlignedBox3d box;       // of the upper beam, desk frame
  std::vector<Vector3d> places;  // sites of the upper beam that may be pressed, desk frame
  Eigen::Matrix3Xd lower_points, upper_points;
};

Eigen::AlignedBox3d box_of(const PlacedDeskBody& body, const Rigid3& desk_from_scene) {
  Eigen::AlignedBox3d box;
  const Rigid3 pose = desk_from_scene * body.scene_from_body;
  for (Eigen::Index v = 0; v < body.body.surface.vertices.cols(); ++v) {
    box.extend(Vector3d(pose * body.body.surface.vertices.col(v)));
  }
  return box;
}

// +1 if the free end is at the right, -1 if at the left. Sites are not near the support, so their
// mean is nearer to the free end.
double free_side(const PlacedDeskBody& body, const Rigid3& desk_from_scene) {
  const Rigid3 pose = desk_from_scene * body.scene_from_body;
  double sum = 0;
  for (const int v : body.body.site_vertices) sum += (pose * body.body.surface.vertices.col(v)).x();
  const double mean = sum / static_cast<double>(body.body.site_vertices.size());
  return mean >= box_of(body, desk_from_scene).center().x() ? 1 : -1;
}

Stack stack_of(std::span<const PlacedDeskBody> bodies) {
  if (bodies.size() != 2) throw Error("the sequence 'beams' is of a scene with two beams");
  Stack stack;
  const auto height = [&](std::size_t k) {
    return box_of(bodies[k], Rigid3::Identity()).center().z();
  };
  stack.upper = height(0) > height(1) ? 0 : 1;
  stack.lower = 1 - stack.upper;
  if (free_side(bodies[stack.upper], stack.desk_from_scene) < 0) {
    stack.desk_from_scene.linear() =
        Eigen::AngleAxisd(std::numbers::pi, Vector3d::UnitZ()).toRotationMatrix();
  }
  stack.box = box_of(bodies[stack.upper], stack.desk_from_scene);
  const Eigen::AlignedBox3d below = box_of(bodies[stack.lower], stack.desk_from_scene);
  stack.gap = stack.box.min().z() - below.max().z();
  if (!(stack.gap >= 0.002 && stack.gap <= 0.060) || below.max().x() < stack.box.center().x()) {
    throw Error(fmt::format(
        "the sequence 'beams' takes two beams above each other with a gap of 2 to 60 mm, free ends "
        "to the same side; these leave {:.1f} mm",
        1e3 * stack.gap));
  }
  const PlacedDeskBody& upper = bodies[stack.upper];
  const Rigid3 pose = stack.desk_from_scene * upper.scene_from_body;
  const Vector3d size = stack.box.sizes();
  for (const int v : upper.body.site_vertices) {
    const Vector3d x = pose * upper.body.surface.vertices.col(v);
    const double along = (x.x() - stack.box.min().x()) / size.x();
    const double beside = std::abs(x.y() - stack.box.center().y()) / size.y();
    if (along < kInner || along > kOuter || beside > kBeside) continue;
    if (stack.box.max().z() - x.z() < 0.001) stack.places.push_back(x);
  }
  if (stack.places.empty()) {
    throw Error("the sequence 'beams' finds no site on top of the upper beam's outer third");
  }
  const auto points_of = [&](std::size_t k) {
    return transformed(sample_surface(bodies[k].body.surface, kBeamSpacing),
                       stack.desk_from_scene * bodies[k].scene_from_body)
        .points;
  };
  stack.lower_points = points_of(stack.lower);
  stack.upper_points = points_of(stack.upper);
  return stack;
}

struct Press {
  Vector3d place;  // on the upper beam
  double depth = 0;
  double in = 0, hold = 0, out = 0;  // duration of the parts of the press, frames
};

Press any_press(const Stack& stack, Random& random) {
  Press press;
  press.place = stack.places[static_cast<std::size_t>(random.unit() *
                                                      static_cast<double>(stack.places.size()))];
  const double more = random.between(0.003, 0.008);
  press.in = random.between(18, 60);
  press.hold = random.between(15, 30);
  press.out = random.between(12, 40);
  // In a slender beam of length L, the free end moves (3 L - a) / (2 a) times as far as the pressed
  // point at distance a from the support.
  const double along = (press.place.x() - stack.box.min().x()) / stack.box.sizes().x();
  press.depth = stack.gap * 2 * along / (3 - along) + more;
  return press;
}

Eigen::Matrix3Xd far_from(const Eigen::Matrix3Xd& points, const Vector3d& place) {
  std::vector<int> far;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    if ((points.col(i) - place).norm() > kAround) far.push_back(static_cast<int>(i));
  }
  return points(Eigen::all, far);
}

// Adds the keys of one press that begins at frame `start`. @return false, without adding them, if
// the hand would touch the lower beam or the upper one elsewhere
bool add_press(const Stack& stack, const Press& press, double tilt, double start, HandPath& path) {
  const Vector3d pointing(-std::sin(tilt), 0, -std::cos(tilt));
  const Vector3d back(-std::cos(tilt), 0, std::sin(tilt));
  const Quaterniond turn = turn_for(path.tool, pointing, back);
  const Vector3d touch = press.place + path.tool.radius * Vector3d::UnitZ();
  const Vector3d down = -Vector3d::UnitZ();
  HandPath trial = path;
  const auto key = [&](double at, const Vector3d& tip, double open) {
    trial.keys.push_back({start + at, tip, turn, open});
  };
  const Vector3d away = touch + Vector3d(0.24, -0.04, 0.16);
  if (trial.keys.empty()) key(0, away, 1.0);
  const double in = press.in, hold = press.hold, out = press.out;
  key(26, touch - kApproach * down, 0.0);
  key(40, touch - 0.006 * down, 0.0);
  key(44, touch, 0.0);
  key(44 + in, touch + press.depth * down, 0.0);
  key(44 + in + hold, touch + press.depth * down, 0.0);
  key(44 + in + hold + out, touch - 0.020 * down, 0.0);
  key(66 + in + hold + out, away, 1.0);
  const Eigen::Matrix3Xd upper = far_from(stack.upper_points, press.place);
  for (double frame = start; frame <= trial.keys.back().frame; frame += 2) {
    const std::vector<Capsule> hand = shapes_of(trial.capsules(frame));
    if (touches(hand, stack.lower_points) || touches(hand, upper)) return false;
  }
  path = std::move(trial);
  return true;
}

}  // namespace

Sequence plan_beams(std::span<const PlacedDeskBody> bodies, int frames, std::uint64_t seed) {
  const Stack stack = stack_of(bodies);
  Random random(seed, "beams");
  HandPath path;
  path.tool = index_finger();
  path.tremor_seed = seed;
  Sequence sequence = tripod_sequence("beams", frames, seed);
  for (double start = kFramesWithoutHand; start < frames;) {
    bool done = false;
    for (int tries = 0; tries < 12 && !done; ++tries) {
      const Press press = any_press(stack, random);
      for (const double tilt : kTilts) {
        if (!add_press(stack, press, tilt, start, path)) continue;
        PlannedTouch touch;
        touch.what = "finger";
        touch.depth = press.depth;
        touch.frames = {
            static_cast<int>(start + 44),
            static_cast<int>(std::ceil(start + 44 + press.in + press.hold + press.out))};
        touch.seconds_to_depth = (4 + press.in) / kFramesPerSecond;
        touch.first_touch = press.place + path.tool.radius * Vector3d::UnitZ();
        touch.direction = -Vector3d::UnitZ();
        if (touch.frames.first < frames) sequence.touches.push_back(touch);
        done = true;
        break;
      }
    }
    if (!done) {
      throw Error(
          "the sequence 'beams': no hand presses the upper beam without meeting more of it");
    }
    start = path.keys.back().frame + 10;
  }
  sequence.look.seed = seed;
  sequence.look.skin_texture = 0.80;
  sequence.look.skin_gloss = 0.22;
  sequence.faults = sensor_faults(seed);
  sequence.desk_from_body = stack.desk_from_scene * bodies.front().scene_from_body;
  sequence.movers = hand_alone(path);
  return sequence;
}

}  // namespace palpable
