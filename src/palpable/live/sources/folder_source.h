/// @file
/// Recorded images in a folder as a source of frames.
///
/// What lies in the folder is recognised as folder_layouts.h says: left/ and right/, color_* or
/// rgb_* with depth_*, left* and right*, images side by side (the left eye in the left half),
/// EuRoC, KITTI, TUM, 7-Scenes. Images are .png, .jpg, .jpeg, .bmp, .ppm, .pgm, .tif or .tiff;
/// depth has 16 bits, in which 0 and 65535 mean unknown.
///
/// A layout that does not bring its calibration has one of these in the folder:
///
///   calibration.yml      the rig of raw images (calibration_file.h)
///   rectified.yml        rows already aligned: fx fy cx cy (px) width height baseline_m doffs_px;
///                        doffs_px is Middlebury's, the right principal point's x minus the left
///                        one's, so Z = f T / (d + doffs)
///   SN*.conf             a ZED's factory numbers (factory_calibration.h)
///   intrinsics.txt       colour + depth: `fx fy cx cy` (px), or `fx fy cx cy width height unit_m`
///                        where unit_m is the length of one depth step; `# ...` is a comment
///
/// Times are the layout's own, else number / fps with fps from an optional `fps` entry of the
/// calibration, else 30.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/live/sources/folder_layouts.h"
#include "palpable/live/sources/frame_source.h"

#include <filesystem>
#include <memory>

namespace palpable {

struct FolderSettings {
  std::filesystem::path calibration{};  ///< instead of what lies in the folder; empty: that
  /// Open stereo images without one, to compute it from them: the format's rig is then empty.
  bool without_calibration = false;
};

/// Opens a folder. The first readable image is decoded to compare its size with the calibration;
/// the others are decoded one frame ahead on a thread of the source's own.
///
/// Problems, one line each with the folder, what was found and what to do: no such folder, nothing
/// recognised, no images, no calibration, a calibration that cannot be read or is for another
/// image size, unequal numbers of left and right (or colour and depth) images.
[[nodiscard]] Result<std::unique_ptr<FrameSource>> open_folder(const std::filesystem::path& folder,
                                                               const FolderSettings& settings = {});

/// The same for images by name (recognise_patterns).
[[nodiscard]] Result<std::unique_ptr<FrameSource>> open_patterns(
    const std::filesystem::path& first, const std::filesystem::path& second, bool second_is_depth,
    const FolderSettings& settings = {});

}  // namespace palpable
