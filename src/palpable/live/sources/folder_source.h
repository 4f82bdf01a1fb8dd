/// @file
/// Recorded images in a folder as a source of frames.
///
/// The layout of the folder is recognised as described in folder_layouts.h: left/ and right/,
/// color_* or rgb_* with depth_*, left* and right*, images side by side (the left eye in the left
/// half), EuRoC, KITTI, TUM, OpenLORIS, 7-Scenes, Stray Scanner, Record3D. Images are .png, .jpg,
/// .jpeg, .bmp, .ppm, .pgm, .tif or .tiff; depth images have 16 bits, in which 0 and 65535 mean
/// unknown, or are .exr, in metres. They may have another size than the colour images
/// (picture_sizes.h).
///
/// If the layout has no calibration of its own, the folder must contain one of these files:
///
///   calibration.yml      the rig of raw images (calibration_file.h)
///   rectified.yml        rows already aligned: fx fy cx cy (px) width height baseline_m doffs_px;
///                        doffs_px is Middlebury's, the right principal point's x minus the left
///                        one's, so Z = f T / (d + doffs)
///   SN*.conf             a ZED's factory numbers (factory_calibration.h)
///   intrinsics.txt       colour + depth: `fx fy cx cy` (px), or `fx fy cx cy width height unit_m`
///                        where unit_m is the length of one depth step, which may also stand in
///                        a line `unit_m 0.001`; `# ...` is a comment
///
/// Times are those of the layout, else number / fps, where fps is an optional `fps` entry of the
/// calibration, else 30.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/live/sources/folder_layouts.h"
#include "palpable/live/sources/frame_source.h"

#include <filesystem>
#include <memory>
#include <optional>

namespace palpable {

struct FolderSettings {
  std::filesystem::path calibration{};  ///< overrides the folder's; empty: the folder's is used
  /// Opens stereo images without a calibration, to compute one; the format's rig is then empty.
  bool without_calibration = false;
  BaselineRule baselines = BaselineRule::kUsual;
  /// m per step of a depth image (depth_unit.h), whatever calibration and layout state.
  std::optional<double> depth_unit{};
};

/// Opens a folder. The first readable image is decoded to compare its size with the calibration;
/// later images are decoded one frame ahead on the source's own thread.
///
/// Problems, each one line with the folder, what was found and what to do: no such folder, unknown
/// layout, no images, no calibration, a calibration that is unreadable or for another image size,
/// different numbers of left and right (or colour and depth) images.
[[nodiscard]] Result<std::unique_ptr<FrameSource>> open_folder(const std::filesystem::path& folder,
                                                               const FolderSettings& settings = {});

/// The same for images by name (recognise_patterns()).
[[nodiscard]] Result<std::unique_ptr<FrameSource>> open_patterns(
    const std::filesystem::path& first, const std::filesystem::path& second, bool second_is_depth,
    const FolderSettings& settings = {});

}  // namespace palpable
