/// @file
/// A body at rest, as a scene shows it. It is copied into the scene in every frame in which nothing
/// touches the body.
///
///   V  surface vertices
#pragma once

#include "palpable/common/reduced/reduced_body.h"
#include "palpable/live/things/scene_body.h"

#include <Eigen/Core>

#include <vector>

namespace palpable {

struct RestShape {
  /// The stress is 0; the body's contact law overwrites it with that of a preload.
  explicit RestShape(const ReducedBody& body);

  /// Copies vertices, normals and stress into `shown`, and clears its contact pressure.
  /// @param extras  whether the components of the stress are copied; else they are cleared
  void show(const SceneExtras& extras, SceneBody& shown) const;
  /// Resizes the arrays of `shown` for a pressed shape, and clears its contact pressure. Other
  /// values are not changed.
  void make_room(const SceneExtras& extras, SceneBody& shown) const;

  Eigen::Matrix3Xf vertices;     ///< (3 x V) m, body frame
  Eigen::Matrix3Xf normals;      ///< (3 x V) unit, outwards
  std::vector<float> von_mises;  ///< (V) Pa
  std::vector<float> cauchy;     ///< (6V) Pa, as SceneBody::cauchy
};

}  // namespace palpable
