/// @file
/// The result of one frame: where bodies are touched, and their deformed shapes and stresses.
///
///   V  surface vertices of a body
#pragma once

#include "palpable/common/base/stage_clock.h"
#include "palpable/common/contact/contact_frame.h"
#include "palpable/common/contact/touch.h"
#include "palpable/common/geometry/image.h"
#include "palpable/live/depth/depth_camera.h"
#include "palpable/live/things/scene_body.h"
#include "palpable/live/track/tracker.h"

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace palpable {

/// "reached", "later", "not reached"; empty: not judged.
[[nodiscard]] constexpr std::string_view text_of(std::optional<Reached> answer) {
  if (!answer) return {};
  switch (*answer) {
    case Reached::kYes:
      return "reached";
    case Reached::kLater:
      return "later";
    case Reached::kNot:
      return "not reached";
  }
  return {};
}

/// Everything that is drawn, written or compared of one frame. Plain data without pointers: it may
/// be kept, copied and passed to another thread.
///
/// A scene is filled in two steps: the depth camera fills `seen`, then Session::respond() fills the
/// rest. A loop uses the same few scenes again and again (swap them, do not copy them): then no
/// step allocates memory once every scene has been filled.
struct Scene {
  SeenFrame seen;  ///< the input: colour and depth of the frame

  int number = 0;              ///< the frame's: seen.number
  double time = 0;             ///< s, the frame's: seen.time
  std::vector<Touch> touches;  ///< of all bodies, the strongest first
  /// Ids of the things that pressed (pressed_bodies.h), to which Touch::thing is an index; empty
  /// where a camera sees what presses.
  std::vector<std::int64_t> things = {};
  /// In the order of the session's bodies.
  std::vector<SceneBody> bodies;
  double mutual_penetration = 0;  ///< m, of bodies into each other, at contact points with force
  double imbalance = 0;  ///< N, by how much the forces between bodies do not cancel; 0 in theory
  /// m that a body has yet to move, because its contact did not converge or the step limit held, or
  /// by which an obstacle is inside it that contact missed (ContactReport::unsolved()); the largest
  /// of all bodies.
  double left_to_move = 0;
  /// m, how deep obstacles still are inside a body's skin anywhere (ContactReport::inside()); the
  /// largest of all bodies. With a camera a few mm are usual while a hand comes fast, and fractions
  /// of one where the depth is uncertain.
  double inside = 0;
  /// Whether the bodies have given way to all that presses. kLater: forces and shapes are on the
  /// way, and the next frame comes nearer. kNot: they are not to be used. Judged of capsules alone:
  /// what a camera sees has no exact surface.
  std::optional<Reached> answer = {};
  /// m, by how much the conditions of friction are not met (ContactReport::friction_residual); the
  /// largest of all bodies. 0 without friction.
  double friction_residual = 0;
  double ringing = 0;        ///< J, of all bodies' motion around their static states
  int contacts_dropped = 0;  ///< contact points near an obstacle for which there was no room
  TrackedPose camera;        ///< identity and kFixed when nothing is tracked
  /// 255 where something moves, of the depth's size. Empty if motion is not searched, or when the
  /// camera is lost.
  MaskImage moving;
  /// 255 where the depth is not the pixel's own (MovingMask::borrowed()). Empty when `moving` is.
  MaskImage borrowed;
  /// Stages as in StageTimes: "rectify" ... "depth" by the depth camera, "track" ... "contact",
  /// "evaluate" by the session. Each half adds its own; clear them before a scene is filled again.
  StageTimes times;
};

}  // namespace palpable
