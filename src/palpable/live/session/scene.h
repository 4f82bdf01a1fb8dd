/// @file
/// The answer to one frame: where bodies are touched and what they then look like.
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

/// What a body of a scene has only if it is asked for (Session::keep). Nothing else of an answer
/// depends on it.
struct SceneExtras {
  bool components = false;        ///< SceneBody::cauchy
  bool contact_pressure = false;  ///< SceneBody::contact_pressure

  friend bool operator==(const SceneExtras&, const SceneExtras&) = default;
};

/// One of a scene's bodies.
struct SceneBody {
  Rigid3 camera_from_body = Rigid3::Identity();  ///< where it is drawn and touched
  Eigen::Matrix3Xf vertices;                     ///< (3 x V) m, body frame, deformed
  Eigen::Matrix3Xf normals;                      ///< (3 x V) unit, outwards
  std::vector<float> von_mises;                  ///< (V) Pa; at rest that of its preload
  /// (6V) Pa, Cauchy stress xx yy zz xy yz zx of each vertex along the body frame's axes, of which
  /// `von_mises` is made; at rest likewise. Empty unless SceneExtras::components are kept.
  std::vector<float> cauchy;
  /// (V) Pa, how hard things press there (contact_pressure.h); 0 where nothing does. Empty unless
  /// SceneExtras::contact_pressure is kept, and of a body that is pressed at its sites alone.
  std::vector<float> contact_pressure;
  /// Of the answer, the obstacle taken as it is seen; nothing where nothing touches or where that
  /// is not known.
  std::optional<StatedError> stated_error;
  /// Share of the skin that has been hidden since the session began: what hides it counts as the
  /// room, and is not felt (hidden_at_start.h).
  double hidden_since_start = 0;
};

/// All that is to be drawn, written or compared of one frame. Plain data without pointers: it may
/// be kept, copied and handed to another thread.
///
/// A scene is filled in two steps: the depth camera fills `seen`, then Session::respond() fills the
/// rest. A loop uses the same few scenes again and again (swap them, do not copy them): then no
/// step allocates memory once every scene has been filled.
struct Scene {
  SeenFrame seen;  ///< the question: colour and depth of the frame

  int number = 0;              ///< the frame's: seen.number
  double time = 0;             ///< s, the frame's: seen.time
  std::vector<Touch> touches;  ///< of all bodies, the strongest first
  /// In the order of the session's.
  std::vector<SceneBody> bodies;
  double between = 0;    ///< m, of bodies into each other, at the points that press
  double imbalance = 0;  ///< N, of the forces between bodies: what one bears and the other does not
  /// m: how far a body has yet to move, where its contact did not converge or it came too far for
  /// one frame (ContactReport::left_to_move); the largest.
  double left_to_move = 0;
  int contacts_dropped = 0;  ///< contact points near something, for which there was no room
  TrackedPose camera;        ///< identity and kFixed when nothing is tracked
  /// 255 where something moves, of the depth's size. Empty when that is not looked for, or when the
  /// camera is lost.
  MaskImage moving;
  /// 255 where the depth is none of the pixel's own (MovingMask::borrowed()). Empty when `moving`
  /// is.
  MaskImage borrowed;
  /// Stages as in StageTimes: "rectify" ... "depth" of seeing, "track" ... "contact", "evaluate" of
  /// answering. Each step adds its own; whoever fills a scene anew clears them first.
  StageTimes times;
};

}  // namespace palpable
