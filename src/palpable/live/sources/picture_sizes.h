/// @file
/// Fits a calibration to the sizes of a recording's pictures.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/live/sources/folder_layouts.h"
#include "palpable/live/sources/source_calibration.h"

#include <filesystem>
#include <optional>

namespace palpable {

/// The size of the first picture of a kind that can be read, px, and its file.
struct SizedPicture {
  int width;
  int height;
  std::filesystem::path path;
};

/// Whether a depth image is OpenEXR, in metres.
[[nodiscard]] bool is_exr(const std::filesystem::path& path);

/// The colour pictures' (or the left eye's, or both eyes') size; nothing if none can be read.
[[nodiscard]] std::optional<SizedPicture> first_color_size(const Recording& recording);

/// The depth images' size; nothing if there are none, or none of the first ten can be read.
[[nodiscard]] std::optional<SizedPicture> first_depth_size(const Recording& recording);

/// The camera whose picture shows the same view with other pixels. The borders of the pictures
/// coincide, so that a pixel's centre, a whole number, moves by half a pixel of each size:
/// c' = (c + 1/2) width / camera.width - 1/2.
[[nodiscard]] PinholeCamera resized(const PinholeCamera& camera, int width, int height);

/// Compares the pictures' size with the calibration's, and sets the format's size if the
/// calibration has none.
///
/// Depth of another size than the colour's becomes that of a depth camera with its own numbers: if
/// the calibration describes both cameras these, else the same view at two sizes. Its numbers are
/// then those of the picture whose size the calibration states, or which the layout says
/// (Recording::calibrates_color), or in whose middle the principal point lies; which one is said in
/// the guesses.
///
/// @param folder  for messages
/// @param depth   of kColorDepth, if any can be read
/// A problem, one line, when sizes do not fit, when colour and depth have other shapes and are
/// described by one camera, or when nothing tells which of the two that camera is.
[[nodiscard]] std::optional<Problem> fit_sizes(const std::filesystem::path& folder,
                                               const Recording& recording,
                                               const SizedPicture& color,
                                               const std::optional<SizedPicture>& depth,
                                               SourceCalibration& calibration);

}  // namespace palpable
