/// @file
/// Transforms the depth image of a depth sensor into the view of a colour camera beside it.
///
/// The colour image is not changed; every measured point is moved to the pixel that shows it, so
/// that drawing, tracking and contact share one view. The opposite, warping colours into the depth
/// sensor's view, would blur the picture and leave holes where there is no depth.
#pragma once

#include "palpable/common/geometry/frame.h"
#include "palpable/common/geometry/image.h"

#include <Eigen/Core>

#include <vector>

namespace palpable {

class DepthRegistration {
 public:
  /// @param depth_camera  of the depth images
  /// @param color         focal lengths of both cameras are positive
  DepthRegistration(const PinholeCamera& depth_camera, const ColorSensor& color);

  /// Three neighbouring depths of one surface (no two differ by more than 6 %) form a triangle. It
  /// is drawn into the colour image with 1/Z linear across it, which is exact on planes; where
  /// triangles overlap, the nearest one is kept. So a surface has no holes where it appears larger
  /// to the colour camera. Half a pixel of it is lost at jumps.
  ///
  /// Corners that were not measured are bridged within the surface (depth_gaps.h), so that depths
  /// with many single holes keep as many pixels as were measured. Such a triangle is drawn only
  /// where the nearest of its corners was measured:
  ///
  ///     m---m---m      m: measured, .: unknown, bridged for its neighbours' sake
  ///     | / | / |      The pixels of the colour image nearer to . than to any m stay unknown.
  ///     m---.---m
  ///
  /// So points that the depth sensor did not measure are unknown, and so is a single pixel without
  /// neighbours. Takes about 10 ns per pixel, twice that where a third is missing; allocates memory
  /// in the first call only.
  ///
  /// @param depth     Z in m, NaN unknown, of the depth camera's size
  /// @param in_color  overwritten: Z in m in the colour camera's frame, NaN unknown, of its size
  /// @throws ContractViolation when the depth has another size
  void to_color(const DepthImage& depth, DepthImage& in_color);

 private:
  /// The image of a depth pixel in the colour camera.
  struct Corner {
    float Z = 0;         // m, of the depth sensor
    float u = 0, v = 0;  // px of the colour image
    float w = 0;         // 1/Z of the colour camera, 1/m; 0: not visible
    bool measured = false;
  };
  void project_row(const DepthImage& depth, int y, std::vector<Corner>& row) const;
  // Whether the nearest corner of a point was not measured.
  // @param in_b, in_c  its barycentric coordinates, times the triangle's area
  static bool is_unmeasured(const Corner& a, const Corner& b, const Corner& c, float in_b,
                            float in_c, float area);
  static void draw(const Corner& a, const Corner& b, const Corner& c, DepthImage& into);

  int width_;
  int height_;
  int color_width_;
  int color_height_;
  // Z M (x, y, 1) + q = w' (u, v, 1): pixel (x, y) at depth Z lies at (u, v) of the colour image,
  // at depth w'.
  Eigen::Matrix3f M_;
  Eigen::Vector3f q_;
  DepthImage bridged_;
  std::vector<Corner> above_;
  std::vector<Corner> below_;
};

}  // namespace palpable
