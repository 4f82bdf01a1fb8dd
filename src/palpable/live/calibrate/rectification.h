/// @file
/// Undistortion and rectification (paper Sec. 3.3, Fig. 5): both eyes become one pinhole camera,
/// shifted by the baseline, so that a point lies on the same row in both.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/image.h"
#include "palpable/common/geometry/yuyv.h"

#include <memory>

namespace palpable {

/// The rectified rig as plain numbers.
struct RectifiedGeometry {
  RectifiedStereo stereo;  ///< as large as the raw images; disparity_at_infinity_px is 0
  Rigid3 rectified_from_left = Rigid3::Identity();   ///< a pure rotation
  Rigid3 rectified_from_right = Rigid3::Identity();  ///< rotation, then T along X
};

/// Both eyes are turned by half of the rotation between them and then together until the baseline
/// is the X axis (Bouguet's method, cv::stereoRectify with zero disparity at infinity and
/// alpha = 0: the largest picture without blank pixels). The result depends on the numbers alone:
/// the same calibration always gives the same camera.
///
/// A problem when the rig is not sound (calibration_file.h) or has no such picture.
[[nodiscard]] Result<RectifiedGeometry> rectify_rig(const StereoRig& rig);

/// The same for a rig that is known to be sound. @throws ContractViolation where it is not
[[nodiscard]] RectifiedGeometry rectified_geometry(const StereoRig& rig);

/// Warps the images of one rig: look-up tables from rectified to raw pixels, in 1/32 px.
class Rectification {
 public:
  /// Computes rectified_geometry and the tables.
  /// @throws ContractViolation when the rig is not sound
  explicit Rectification(const StereoRig& rig);
  /// For images that are rectified already: nothing is warped until turn_right().
  explicit Rectification(const RectifiedStereo& stereo);
  Rectification(Rectification&&) noexcept;
  Rectification& operator=(Rectification&&) noexcept;
  ~Rectification();

  [[nodiscard]] const RectifiedGeometry& geometry() const { return geometry_; }

  enum class Eye { kLeft, kRight };

  /// Turns the right eye by a small rotation: from now on its rays are `turn` times what they were.
  /// A rig that was knocked or has become warm needs this (row_watch.h). Costs as much time as a
  /// few frames.
  void turn_right(const Eigen::Matrix3d& turn);

  /// The rectified image.
  /// @throws ContractViolation when the image has another size than the rig
  void rectify(Eye eye, const ColorImage& raw, ColorImage& rectified);
  /// The luma of the rectified image; the same exception.
  void rectify_luma(Eye eye, const ColorImage& raw, GrayImage& rectified);

  /// The same for pictures as cameras send them, which are read where they lie (yuyv_kernels.h):
  /// luma of either eye, and the colours of the left one.
  ///
  /// Against the functions above, after a conversion to colours, luma differs by 1 level on average
  /// and by 4 at an edge: it is not rounded to colours first, and positions between two of 8 px lie
  /// on a straight line. Where colours leave 0 .. 255 luma is truer.
  /// @param both  Frame::both
  /// @throws ContractViolation when it has another size than the rig's eyes together
  void rectify_luma(Eye eye, const YuyvImage& both, GrayImage& rectified);
  /// @param luma  of the left eye, rectified
  void rectify_left(const YuyvImage& both, const GrayImage& luma, ColorImage& rectified);

  /// Luma of a colour image: 0.299 R + 0.587 G + 0.114 B, rounded (cv::COLOR_RGB2GRAY).
  static void luma(const ColorImage& color, GrayImage& luma);
  /// Means of two by two pixels; of an odd size the last row or column is left out.
  static void halve(const GrayImage& image, GrayImage& half);

 private:
  struct Maps;
  void make_tables(Eye eye);
  RectifiedGeometry geometry_;
  std::unique_ptr<Maps> maps_;
};

}  // namespace palpable
