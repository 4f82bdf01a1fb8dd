/// @file
/// Recorded images in a folder as a source of frames.
///
/// Recognised by what lies in the folder, in this order:
///
///   left/ right/         stereo pairs, matched by position after natural sorting (2 before 10)
///   color_* or rgb_* with depth_*
///                        colour + depth; depth is a 16-bit image; intrinsics.txt says the rest:
///                        the line `fx fy cx cy` (px), or `fx fy cx cy width height unit_m` where
///                        unit_m is the length of one depth step (default 0.001); `# ...` is a
///                        comment; depth 0 and 65535 mean unknown
///   images twice as wide as the calibration
///                        stereo pairs side by side, the left eye in the left half
///
/// Images are .png, .jpg, .jpeg, .bmp, .ppm, .pgm, .tif or .tiff. A stereo folder has one of
///
///   calibration.yml      the rig of raw images (calibration_file.h)
///   rectified.yml        rows already aligned: fx fy cx cy (px) width height baseline_m doffs_px
///
/// directly in it; doffs_px is Middlebury's, the right principal point's x minus the left one's, so
/// Z = f T / (d + doffs). Times are number / fps with fps from an
/// optional `fps` entry of either file, else 30.
#pragma once

#include "palpable/base/error.h"
#include "palpable/vision/frame_source.h"

#include <filesystem>
#include <memory>

namespace palpable {

/// Opens a folder. The first readable image is decoded to compare its size with the calibration;
/// the others are decoded one frame ahead on a thread of the source's own.
///
/// Problems, one line each with the folder, what was found and what to do: no such folder, nothing
/// recognised, no images, no calibration, a calibration that cannot be read or is for another
/// image size, unequal numbers of left and right (or colour and depth) images.
[[nodiscard]] Result<std::unique_ptr<FrameSource>> open_folder(const std::filesystem::path& folder);

}  // namespace palpable
