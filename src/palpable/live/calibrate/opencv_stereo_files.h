/// @file
/// The two files that OpenCV's sample stereo_calib writes and stereo_match reads:
///
///   intrinsics.yml   M1 D1 M2 D2: both lenses, px
///   extrinsics.yml   R T, with x_right = R x_left + T, and R1 R2 P1 P2 Q, which follow from these
///
/// or one file with all of them, under these names or others that OpenCV's users give them (K1,
/// cameraMatrix1, distCoeffs1, ...). They state neither the size of the pictures nor the unit of T,
/// which is that of the board's squares: 1 a square unless the sample was given their side.
#pragma once

#include "palpable/live/calibrate/foreign_lens.h"

namespace palpable {

[[nodiscard]] bool has_opencv_lenses(const KeyedText& text);
[[nodiscard]] bool has_opencv_pose(const KeyedText& text);

/// @param lenses, pose    the two files; the same one if it has both
/// @param width, height   px, of the pictures, used if the files state none; 0: unknown
/// @return the rig; its pictures are 0 x 0 where nothing states their size. Problems: a matrix that
/// is missing or no such one, a rational lens, a principal point that is not near the middle of
/// pictures of the given size, so that the files are for another one.
[[nodiscard]] Result<StereoRig> rig_of_opencv(const KeyedText& lenses, const KeyedText& pose,
                                              int width, int height);

/// Whether one of the files states the size.
[[nodiscard]] bool states_opencv_size(const KeyedText& text);

/// The same rig as the texts of intrinsics.yml and extrinsics.yml, the second with R1 R2 P1 P2 Q.
/// @pre  the rig can be rectified
struct OpencvTexts {
  std::string intrinsics;
  std::string extrinsics;
};
[[nodiscard]] OpencvTexts opencv_texts(const StereoRig& rig);

}  // namespace palpable
