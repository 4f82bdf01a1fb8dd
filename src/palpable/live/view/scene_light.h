/// @file
/// The light of the room, estimated from what the camera sees: bodies are drawn in it.
///
/// **Model.** Surfaces are matt; one lamp and the room light them; what has one
/// hue in one of 8 x 5 parts of the picture has one albedo (one paint):
///
///     I_p = rho_k(p) ( 1 + max(0, b . n_p) )
///
/// with I_p the linear luminance of a pixel, n_p its surface's normal (from the depth), k(p) its
/// paint and rho_k one unknown for each. b points to the lamp; |b| is its share against the room's
/// light, and comes out too small: noise of the normals blurs it. Shading within one paint says
/// what b is: a hand, a mug. Flat paints say nothing and are left out; of a bare desk b is what is
/// usual (usual_lamp()), which has a small weight always.
///
/// b is a weighted least-squares fit with Cauchy weights (shadows, highlights and prints are not in
/// the model), rho_k the median of its paint; some rounds of both, from the last estimate on. Few
/// frames are asked, and the estimate follows slowly: light that flickers is worse than light that
/// is late.
///
/// Brightness is the geometric mean of the picture's linear luminance against kUsualMean: cameras
/// expose a lit desk so, and a body must get darker with its picture. Colour is the picture's mean
/// hue (grey world), a quarter of it: the rest is the desk's own.
#pragma once

#include "palpable/common/geometry/rigid.h"
#include "palpable/live/depth/seen_frame.h"
#include "palpable/live/render/scene_renderer.h"

#include <Eigen/Core>

#include <vector>

namespace palpable {

/// Light in a frame of its user's.
struct RoomLight {
  Eigen::Vector3d to_light = Eigen::Vector3d::UnitZ();  ///< unit
  double directed = 1.5;                                ///< |b|: 0 the same from everywhere
  double brightness = 1;                                ///< 1: a desk in a well lit room
  Eigen::Vector3d tint = Eigen::Vector3d::Ones();       ///< linear R, G, B; their mean is 1
};

/// The renderer's light. @param camera_from_body  from the light's frame
[[nodiscard]] SceneLight light_in_camera(const RoomLight& light, const Rigid3& camera_from_body);

/// Follows the light of a room. Deterministic; allocates nothing after the first frame.
class LightEstimator {
 public:
  static constexpr int kEvery = 10;           ///< frames from one that is asked to the next
  static constexpr double kUsualMean = 0.28;  ///< of the linear luminance, 1 being white

  /// @param camera_from_body  where the light's frame is; its Z is up
  void see(const SeenFrame& seen, const Rigid3& camera_from_body);

  /// In the body's frame.
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
  std::vector<char> flat_;           // of each paint: of one normal, or of too few samples
  std::vector<double> albedo_;       // of each paint; 0: it does not count
};

}  // namespace palpable
