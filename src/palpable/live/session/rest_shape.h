/// @file
/// A body that nothing presses, as a scene shows it: copied in every frame in which nothing
/// touches.
///
///   V  surface vertices
#pragma once

#include "palpable/common/reduced/reduced_body.h"
#include "palpable/live/session/scene.h"

#include <Eigen/Core>

#include <vector>

namespace palpable {

struct RestShape {
  /// Without stress; whoever knows that of a preload writes it.
  explicit RestShape(const ReducedBody& body);

  /// Copies vertices, normals and stress into `shown`, and clears its contact pressure.
  /// @param extras  whether the components of the stress are wanted, too; else they are cleared
  void show(const SceneExtras& extras, SceneBody& shown) const;
  /// Gives the arrays of `shown` the sizes that a pressed shape needs, and clears its contact
  /// pressure. What stands in them is not changed otherwise.
  void make_room(const SceneExtras& extras, SceneBody& shown) const;

  Eigen::Matrix3Xf vertices;     ///< (3 x V) m, body frame
  Eigen::Matrix3Xf normals;      ///< (3 x V) unit, outwards
  std::vector<float> von_mises;  ///< (V) Pa
  std::vector<float> cauchy;     ///< (6V) Pa, as SceneBody::cauchy
};

}  // namespace palpable
