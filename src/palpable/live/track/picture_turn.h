/// @file
/// The turn of a camera between two pictures, from the shift of the whole picture. It is the first
/// guess of a pose when the last motion predicts nothing useful: a camera that turns by 3 degrees
/// from one frame to the next moves its picture by 40 px, which is about as far as patches can be
/// followed.
#pragma once

#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/image.h"

#include <Eigen/Core>

#include <optional>

namespace palpable {

/// A picture and the same at half the size, to compare later pictures with.
class PictureTurn {
 public:
  /// Keeps a copy of a picture. Does not allocate if it has the size of the one before.
  /// @param eighth  at an eighth of the full size (Pyramid::level(3))
  void keep(const GrayImage& eighth) { kept_ = eighth; }

  /// The rotation R, x_in_later = R x_in_kept, that shifts the middle of the kept picture to where
  /// it is found in a later one. Translation and roll are not estimated: a near scene shifts with
  /// both. Shifts of up to 16 px of the eighth are tried in x and in y, or less in a small picture:
  /// half of the picture must remain in view. Takes about 0.3 ms for a picture of 1280 x 720.
  /// @param camera  of the full picture
  /// Does not allocate after the first call.
  /// @return nothing if no picture of this size was kept, or if no shift makes the pictures alike
  [[nodiscard]] std::optional<Eigen::Matrix3d> turn_to(const GrayImage& eighth,
                                                       const PinholeCamera& camera);

 private:
  GrayImage kept_;
  GrayImage half_kept_, half_later_;  // work space
};

}  // namespace palpable
