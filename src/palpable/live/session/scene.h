/// @file
/// The result of one frame: where bodies are touched, and their deformed shapes and stresses.
///
///   V  surface vertices of a body
#pragma once

#include "palpable/common/base/stage_clock.h"
#include "palpable/common/contact/touch.h"
#include "palpable/common/geometry/image.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/common/response/stated_error.h"
#include "palpable/live/depth/depth_camera.h"
#include "palpable/live/track/tracker.h"

#include <Eigen/Core>

#include <optional>
#include <vector>

namespace palpable {

/// Arrays of a scene's bodies that are filled only on request (Session::keep). Nothing else of a
/// scene depends on them.
struct SceneExtras {
  bool components = false;        ///< SceneBody::cauchy
  bool contact_pressure = false;  ///< SceneBody::contact_pressure

  friend bool operator==(const SceneExtras&, const SceneExtras&) = default;
};

/// One of a scene's bodies.
struct SceneBody {
  Rigid3 camera_from_body = Rigid3::Identity();  ///< the body's pose in the frame
  Eigen::Matrix3Xf vertices;                     ///< (3 x V) m, body frame, deformed
  Eigen::Matrix3Xf normals;                      ///< (3 x V) unit, outwards
  std::vector<float> von_mises;                  ///< (V) Pa; at rest that of the preload
  /// (6V) Pa, Cauchy stress xx yy zz xy yz zx of each vertex along the body frame's axes, from
  /// which `von_mises` is computed. Empty unless SceneExtras::components are kept.
  std::vector<float> cauchy;
  /// (V) Pa, contact pressure (contact_pressure.h); 0 where nothing presses. Empty unless
  /// SceneExtras::contact_pressure is kept, and for a body that is pressed at its sites only.
  std::vector<float> contact_pressure;
  /// The error of displacement and stress, for the obstacle as it is seen; nothing without a touch,
  /// or where it is not known.
  std::optional<StatedError> stated_error;
  /// Share of the skin's vertices that have been hidden since the session began: their occluder
  /// counts as part of the room, and its touches are not detected (hidden_at_start.h).
  double hidden_since_start = 0;
};

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
  /// In the order of the session's bodies.
  std::vector<SceneBody> bodies;
  double mutual_penetration = 0;  ///< m, of bodies into each other, at contact points with force
  double imbalance = 0;  ///< N, by how much the forces between bodies do not cancel; 0 in theory
  /// m that a body has yet to move, because its contact did not converge or the step limit held
  /// (ContactReport::left_to_move); the largest of all bodies.
  double left_to_move = 0;
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
