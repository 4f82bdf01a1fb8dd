/// @file
/// Pictures of a touch: the response of a body's tables beside the full-order solution in the same
/// colours, and their difference.
#pragma once

#include "palpable/bake/touch_bake/touch_difference.h"
#include "palpable/bake/touch_bake/touch_scenes.h"
#include "palpable/common/geometry/image.h"
#include "palpable/common/geometry/surface_mesh.h"
#include "palpable/live/render/scene_renderer.h"
#include "palpable/live/render/studio.h"

#include <Eigen/Core>

#include <string>

namespace palpable {

/// Draws with the OpenGL context that is current at construction, which must be
/// current in every call.
class TouchPictures {
 public:
  /// @param skin  before the press; must outlive this
  /// @throws Error when the shaders do not compile
  explicit TouchPictures(const SurfaceMesh& skin);

  /// Three views of 640 x 640 px: von Mises stress on the deformed body according to the
  /// tables, the same according to the full-order solution, and the distance between the two
  /// positions of each vertex.
  [[nodiscard]] ColorImage draw(const TouchScene& scene, const TouchDifference& difference);

 private:
  struct Painted {
    const Eigen::Matrix3Xf& displacement;  // (3 x V) m
    const Eigen::VectorXf& scalar;         // (V)
    float largest = 1;
    std::string legend, unit, caption;
    double legend_scale = 1;
  };

  const SurfaceMesh& skin_;
  Studio studio_;
  SceneRenderer renderer_;

  ColorImage draw(const Painted& painted, const Eigen::Vector3d& towards);
};

}  // namespace palpable
