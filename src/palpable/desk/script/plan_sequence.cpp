#include "palpable/desk/script/plan_sequence.h"

#include "palpable/common/base/contract.h"
#include "palpable/desk/script/camera_motions.h"
#include "palpable/desk/script/cup.h"
#include "palpable/desk/script/cup_turn.h"
#include "palpable/desk/script/demo.h"
#include "palpable/desk/script/disturbances.h"
#include "palpable/desk/script/press_targets.h"
#include "palpable/desk/script/presses.h"
#include "palpable/desk/script/random.h"
#include "palpable/desk/script/squeezes.h"
#include "palpable/desk/script/working_hand.h"

#include <algorithm>
#include <array>
#include <numbers>

namespace palpable {

namespace {

constexpr std::array kKinds = {
    SequenceKind{"still", 1000, "the camera held in a hand, nothing else moves"},
    SequenceKind{"still-tripod", 1000, "nothing moves"},
    SequenceKind{"walk", 900, "more than 6 m through the room, with a look away"},
    SequenceKind{"shake", 600, "the camera is shaken"},
    SequenceKind{"blur", 600, "fast turns with motion blur"},
    SequenceKind{"still-hand", 1000, "still, with a hand at work before the camera"},
    SequenceKind{"walk-hand", 900, "walk, with a hand at work before the camera"},
    SequenceKind{"blur-hand", 600, "blur, with a hand at work before the camera"},
    SequenceKind{"press", 600, "a finger presses the body, 3-14 mm deep, at several speeds"},
    SequenceKind{"pencil", 600, "the tip of a pencil presses the body"},
    SequenceKind{"pencil-turn", 600, "a pencil is turned in view, then presses away from the eye"},
    SequenceKind{"cup", 600, "a cup is put against the body and left there"},
    SequenceKind{"cup-turn", 600, "a cup is turned in view, then presses with its far side"},
    SequenceKind{"slide", 600, "a finger slides along the body"},
    SequenceKind{"palm", 600, "a flat hand presses the body"},
    SequenceKind{"two-hands", 600, "two hands press the body"},
    SequenceKind{"squeeze", 600, "finger and thumb press the body from two sides at once"},
    SequenceKind{"rest", 750, "a finger is laid on the body and rests there for 20 s"},
    SequenceKind{"press-axial", 600, "presses along the line of sight: the finger hides them"},
    SequenceKind{"press-behind", 600, "presses from behind the body"},
    SequenceKind{"dark", 600, "press with little light and much noise"},
    SequenceKind{"textureless", 600, "press on a bare white desk in a bare room"},
    SequenceKind{"exposure", 600, "press while the exposure jumps"},
    SequenceKind{"rolling", 600, "press, the camera sways, rows are read one after the other"},
    SequenceKind{"drift", 600, "press while the right camera sinks by steps and a ramp"},
    SequenceKind{"demo", 360,
                 "the clip of ./demo: three presses, a hand before and behind, a squeeze"},
};

/// A sequence without presses: a camera that is fixed, hand-held or moving, with or without a
/// working hand.
Sequence plan_motion(std::string_view name, std::string_view motion, bool with_hand, int frames,
                     std::uint64_t seed) {
  Sequence sequence = tripod_sequence(name, frames, seed);
  Random random(seed, "yaw");
  sequence.desk_from_body = turned_body(random.between(0.0, 2.0 * std::numbers::pi));
  CameraPath path = sequence.camera_from_desk;
  if (motion == "walk") path = walk();
  if (motion == "blur") path = fast_turns(seed);
  // The working hand follows the camera's path without its tremor.
  const CameraPath smooth = path;
  if (motion == "shake") path = shaken(seed);
  sequence.camera_from_desk =
      motion == "still-tripod" ? path : held(path, std::max(frames, 30), seed);
  if (with_hand) sequence.movers = working_hand(smooth, frames, seed);
  // s; a rotation of 100 degrees/s then gives a motion blur of 15 px.
  const double exposure = motion == "blur" ? 0.012 : 0.0;
  sequence.rig = [exposure](int) { return RigState{.exposure = exposure}; };
  return sequence;
}

}  // namespace

std::span<const SequenceKind> sequence_kinds() { return kKinds; }

Sequence plan_sequence(std::string_view name, const DeskBody& body, int frames,
                       std::uint64_t seed) {
  PALPABLE_EXPECT(frames >= 1, "a sequence has frames");
  PALPABLE_EXPECT(
      body.surface.vertex_count() > 0 && !body.site_vertices.empty() &&
          body.directions.cols() == static_cast<Eigen::Index>(body.site_vertices.size()),
      "the body has vertices, and one direction per site");
  Sequence sequence;
  const bool with_hand = name.ends_with("-hand");
  const std::string_view motion = with_hand ? name.substr(0, name.size() - 5) : name;
  if (motion == "still" || motion == "still-tripod" || motion == "walk" || motion == "shake" ||
      motion == "blur") {
    sequence = plan_motion(name, motion, with_hand, frames, seed);
  } else if (name == "demo") {
    sequence = plan_demo(body, frames, seed);
  } else if (name == "cup") {
    sequence = plan_cup(body, frames, seed);
  } else if (name == "cup-turn") {
    sequence = plan_cup_turn(body, frames, seed);
  } else if (name == "squeeze") {
    sequence = plan_squeezes(body, frames, seed);
  } else if (is_disturbance(name)) {
    sequence = plan_presses("press", body, frames, seed);
  } else {
    sequence = plan_presses(name, body, frames, seed);
  }
  sequence.look.seed = seed;
  if (name != "demo") {
    // With these values OpenCV's SGBM measures 65 to 85 % of the pixels of a near hand within 1 %
    // of their depth (palpable bench sgbm-reference prints the share). More contrast would make
    // hands too easy to measure.
    sequence.look.skin_texture = 0.80;
    sequence.look.skin_gloss = 0.22;
  }
  sequence.faults = sensor_faults(seed);
  if (is_disturbance(name)) disturb(name, sequence);
  return sequence;
}

}  // namespace palpable
