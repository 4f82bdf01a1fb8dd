/// @file
/// Undistortion and rectification (paper Sec. 3.3, Fig. 5): the images of both eyes are warped to
/// those of two equal pinhole cameras, displaced by the baseline along X, so that a point lies on
/// the same row in both.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/image.h"

#include <memory>

namespace palpable {

/// The rectified rig as plain numbers.
struct RectifiedGeometry {
  RectifiedStereo stereo;  ///< as large as the raw images; disparity_at_infinity_px is 0
  Rigid3 rectified_from_left = Rigid3::Identity();   ///< a pure rotation
  Rigid3 rectified_from_right = Rigid3::Identity();  ///< rotation, then T along X
};

/// Computes the rectification of a rig. Both eyes are turned by half of the rotation between them,
/// and then together until the baseline is the X axis (Bouguet's method, cv::stereoRectify with
/// zero disparity at infinity and alpha = 0: the largest picture without blank pixels). The same
/// calibration always gives the same result.
///
/// Returns a problem if the rig is not valid (calibration_check.h) or there is no such picture.
[[nodiscard]] Result<RectifiedGeometry> rectify_rig(const StereoRig& rig);

/// The same for a rig that is known to be valid.
/// @throws ContractViolation if it is not
[[nodiscard]] RectifiedGeometry rectified_geometry(const StereoRig& rig);

/// Warps the images of one rig with look-up tables from rectified to raw pixels, in 1/32 px.
class Rectification {
 public:
  /// Computes rectified_geometry and the tables.
  /// @throws ContractViolation if the rig is not valid
  explicit Rectification(const StereoRig& rig);
  /// For images that are rectified already: nothing is warped until turn_right().
  explicit Rectification(const RectifiedStereo& stereo);
  Rectification(Rectification&&) noexcept;
  Rectification& operator=(Rectification&&) noexcept;
  ~Rectification();

  [[nodiscard]] const RectifiedGeometry& geometry() const { return geometry_; }

  enum class Eye { kLeft, kRight };

  /// Corrects the right eye by a small rotation: from now on its rays are multiplied by `turn`.
  /// This is needed when a rig was knocked or has become warm (row_watch.h). Takes as long as a few
  /// frames.
  void turn_right(const Eigen::Matrix3d& turn);

  /// The rectified image.
  /// @throws ContractViolation if the image's size is not that of the rig
  void rectify(Eye eye, const ColorImage& raw, ColorImage& rectified);
  /// The luma of the rectified image; the same exception.
  void rectify_luma(Eye eye, const ColorImage& raw, GrayImage& rectified);

  /// The same directly from the YUYV pictures that cameras send (yuyv_kernels.h), without a
  /// conversion or copy: luma of either eye, and the colours of the left one.
  ///
  /// Compared with the functions above on a picture that was converted to colours, luma differs by
  /// 1 level on average and by 4 at an edge. The reasons are that it is not rounded to colours
  /// first, and that positions within 8 px are interpolated linearly. Where colours are clipped to
  /// 0 .. 255, this luma is more accurate.
  /// @param both  Frame::both
  /// @throws ContractViolation if its size is not that of the rig's two eyes side by side
  void rectify_luma(Eye eye, const YuyvImage& both, GrayImage& rectified);
  /// @param luma  of the left eye, rectified
  void rectify_left(const YuyvImage& both, const GrayImage& luma, ColorImage& rectified);

  /// Luma of a colour image: 0.299 R + 0.587 G + 0.114 B, rounded (cv::COLOR_RGB2GRAY).
  static void luma(const ColorImage& color, GrayImage& luma);
  /// Means of 2 x 2 pixels; if the size is odd, the last row or column is left out.
  static void halve(const GrayImage& image, GrayImage& half);

 private:
  struct Maps;
  void make_tables(Eye eye);
  RectifiedGeometry geometry_;
  std::unique_ptr<Maps> maps_;
};

}  // namespace palpable
