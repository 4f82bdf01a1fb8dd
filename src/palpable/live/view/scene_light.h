/// @file
/// Estimates the light of the room from the camera's pictures, so that bodies can be drawn in it.
///
/// **Model.** Surfaces are matt, and are lit by one lamp and by the room. Pixels of one hue in one
/// of 8 x 5 parts of the picture are called a paint, and have one albedo:
///
///     I_p = rho_k(p) ( 1 + max(0, b . n_p) )
///
/// with I_p the linear luminance of a pixel, n_p the normal of its surface (from the depth), k(p)
/// its paint, and rho_k an unknown for each paint. b points to the lamp; |b| is the ratio of the
/// lamp's light to the room's, and is estimated too small, because noise of the normals blurs the
/// shading. Shading within one paint determines b (a hand, a mug). Flat paints do not, and are left
/// out. For a bare desk b is the usual light (usual_lamp()), which enters every fit with a small
/// weight.
///
/// b is a weighted least-squares fit with Cauchy weights (shadows, highlights and prints are not in
/// the model), and rho_k the median over its paint; both are repeated for some rounds, beginning
/// with the last estimate. Only every tenth frame is used, and the estimate follows slowly: light
/// that flickers would be worse than light that lags.
///
/// Brightness is the ratio of the geometric mean of the picture's linear luminance to kUsualMean,
/// the mean to which cameras expose a lit desk; so a body gets darker when its picture does. The
/// light's colour is the picture's mean hue (grey-world assumption), reduced to a quarter, since
/// the rest is the colour of the desk.
#pragma once

#include "palpable/common/geometry/rigid.h"
#include "palpable/live/depth/seen_frame.h"
#include "palpable/live/render/scene_renderer.h"

#include <Eigen/Core>

#include <vector>

namespace palpable {

/// The light of a room, in a frame that the user of LightEstimator chooses.
struct RoomLight {
  Eigen::Vector3d to_light = Eigen::Vector3d::UnitZ();  ///< unit
  double directed = 1.5;                                ///< |b|; 0: equal from all directions
  double brightness = 1;                                ///< 1: a desk in a well lit room
  Eigen::Vector3d tint = Eigen::Vector3d::Ones();       ///< linear R, G, B; their mean is 1
};

/// Converts to the renderer's light. @param camera_from_body  the body frame is that of `light`
[[nodiscard]] SceneLight light_in_camera(const RoomLight& light, const Rigid3& camera_from_body);

/// Follows the light of a room. Deterministic; allocates nothing after the first frame.
class LightEstimator {
 public:
  static constexpr int kEvery = 10;           ///< frames from one that is used to the next
  static constexpr double kUsualMean = 0.28;  ///< of the linear luminance, with 1 for white

  /// Adds a frame. @param camera_from_body  pose of the light's frame, whose Z is up
  void see(const SeenFrame& seen, const Rigid3& camera_from_body);

  /// The present estimate, in the body's frame.
  [[nodiscard]] const RoomLight& light() const { return light_; }

 private:
  struct Sample {
    Eigen::Vector3f normal;  // camera frame
    float luminance;
    int paint;
  };
  void sample_surfaces(const SeenFrame& seen);
  [[nodiscard]] Eigen::Vector3d fit(Eigen::Vector3d b, const Eigen::Vector3d& usual);
  void fit_albedos(const Eigen::Vector3d& b);

  int until_next_ = 0;  // frames
  bool began_ = false;
  RoomLight light_;
  Eigen::Vector3d fitted_ = Eigen::Vector3d::Zero();  // b of the last fit, body frame
  std::vector<Sample> samples_;
  std::vector<int> first_of_paint_;  // (paints + 1) into by_paint_
  std::vector<float> by_paint_;      // luminance over light, sorted by paint
  std::vector<char> flat_;           // per paint: not 0 if it has one normal or too few samples
  std::vector<double> albedo_;       // per paint; 0: it is left out
};

}  // namespace palpable
