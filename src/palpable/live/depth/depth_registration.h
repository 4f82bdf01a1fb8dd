/// @file
/// Depth as a colour camera beside the depth sensor would have seen it.
///
/// The colour image stays as it was taken; every measured point is moved to the pixel that shows
/// it, so that drawing, tracking and contact share one view. Moving the colours to the depth's view
/// instead would blur the picture and leave holes where the depth sensor saw nothing.
#pragma once

#include "palpable/common/geometry/frame.h"
#include "palpable/common/geometry/image.h"

#include <Eigen/Core>

#include <vector>

namespace palpable {

class DepthRegistration {
 public:
  /// @param depth_camera  of the depth images; focal lengths positive, as the colour's
  DepthRegistration(const PinholeCamera& depth_camera, const ColorSensor& color);

  /// Three neighbouring depths of one surface (no two differ by more than 6 %) form a triangle. It
  /// is drawn into the colour image with 1/Z linear across it, which is exact on planes; where
  /// triangles overlap, the nearest one counts. So a surface gets no holes where the colour camera
  /// sees it larger. Half a pixel of it is lost at jumps and around unknown pixels; what the depth
  /// sensor did not see is unknown, as is a single pixel without neighbours. About 10 ns per pixel;
  /// allocates memory in the first call only.
  ///
  /// @param depth     Z in m, NaN unknown, of the depth camera's size
  /// @param in_color  overwritten: Z in m in the colour camera's frame, NaN unknown, of its size
  /// @throws ContractViolation when the depth has another size
  void to_color(const DepthImage& depth, DepthImage& in_color);

 private:
  /// Where a depth pixel is seen: pixel of the colour image and 1/Z there; w = 0: nowhere.
  struct Corner {
    float Z = 0;  // of the depth sensor
    float u = 0, v = 0, w = 0;
  };
  void project_row(const DepthImage& depth, int y, std::vector<Corner>& row) const;
  static void draw(const Corner& a, const Corner& b, const Corner& c, DepthImage& into);

  int width_;
  int height_;
  int color_width_;
  int color_height_;
  // Z (M (x, y, 1)) + q is the colour camera's pixel of (x, y) at depth Z, times its depth there.
  Eigen::Matrix3f M_;
  Eigen::Vector3f q_;
  std::vector<Corner> above_;
  std::vector<Corner> below_;
};

}  // namespace palpable
