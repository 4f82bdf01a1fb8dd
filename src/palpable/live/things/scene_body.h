/// @file
/// One body as it is shown after a frame, whatever pressed it: its deformed shape and its stress.
///
///   V  surface vertices of a body
#pragma once

#include "palpable/common/geometry/rigid.h"
#include "palpable/common/response/stated_error.h"

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

}  // namespace palpable
